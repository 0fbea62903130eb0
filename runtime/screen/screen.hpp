// What a dfield_screen is: settings, sample sets, and memory that stays from frame to frame.
#pragma once

#include "context.hpp"
#include "screen/estimate.hpp"

struct dfield_screen final : dfield::runtime::Shared<dfield_screen> {
    dfield_screen(dfield_context* context, const dfield::runtime::screen::Settings& settings);

    void shade(const dfield_screen_buffers& buffers, const dfield_screen_outputs& outputs);
    void integral(const dfield_screen_buffers& buffers, const std::uint32_t* pixels, std::size_t count,
                  float* visibility, float* indirect);

  private:
    // At least `count` floats; what they held is lost.
    float* memory_of(std::size_t count);
    dfield::runtime::screen::Frame decoded(const dfield_screen_buffers& buffers, float* depth) const;

    const dfield::runtime::screen::Settings settings_;
    const dfield::runtime::screen::SampleSets<dfield::runtime::screen::DiskSample> disk_;
    const dfield::runtime::screen::PointSets points_;
    dfield::runtime::screen::Buffer<float> memory_;
    std::size_t size_ = 0;
};
