// A G-buffer through the runtime, timed, and its errors against brute force and against rays.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "baker/cli/runtime_scene.hpp"
#include "baker/cli/screen_input.hpp"
#include "baker/screen/ray_reference.hpp"
#include "dfield/screen.h"

namespace dfield::cli {

struct ScreenShading {
    std::vector<float> visibility;
    std::vector<glm::vec3> indirect, reflected;  // empty unless indirect light was asked for
    double ms = 0;  // the fastest call that writes visibility, or with indirect light reflected radiance
};

struct ReferenceOptions {
    std::size_t pixels = 1024;  // at most so many, spread over those that show a surface
    std::uint32_t rays = 512;
};

// What a frame is held against, at some pixels. In world space: empty where there is no scene.
struct ScreenReference {
    std::vector<float> screen;               // the brute-force integral of the desc's estimator
    std::vector<glm::vec3> screen_indirect;  // empty unless asked for
    RayReference world;
};

class ScreenRunner {
  public:
    // The subject must outlive this. Throws InputError for what the runtime refuses.
    ScreenRunner(const ScreenSubject& subject, int threads, const ReferenceOptions& reference,
                 dfield_simd simd = DFIELD_SIMD_BEST);

    const Context& context() const { return context_.get(); }
    // The subject's buffer with the normals that the runtime uses: its own, or derived from depth.
    const GBuffer& buffer() const { return buffer_; }
    std::span<const std::uint32_t> pixels() const { return pixels_; }  // of the references

    ScreenShading shade(const dfield_screen_desc& desc, bool indirect, int repetitions) const;
    std::vector<float> integral(const dfield_screen_desc& desc,
                                std::vector<glm::vec3>* indirect = nullptr) const;
    // Empty where there is no scene.
    RayReference by_rays(const dfield_screen_desc& desc, bool indirect, bool unbounded) const;
    // Visibility by rays at every pixel. There is a scene.
    std::vector<float> picture_by_rays(const dfield_screen_desc& desc, std::uint32_t rays,
                                       bool unbounded) const;

    // values at the reference pixels
    template<class Value>
    std::vector<Value> at_pixels(const std::vector<Value>& frame) const {
        std::vector<Value> values;
        for (const std::uint32_t pixel : pixels_) values.push_back(frame[pixel]);
        return values;
    }

  private:
    dfield_screen_buffers view() const;
    RayReference trace(std::span<const std::uint32_t> pixels, std::uint32_t rays,
                       const dfield_screen_desc& desc, bool indirect, bool unbounded) const;

    const ScreenSubject& subject_;
    int threads_;
    std::uint32_t rays_;
    ThreadedContext context_;
    GBuffer buffer_;
    std::vector<std::uint32_t> pixels_;
};

// Root mean square difference in grey levels of 0..255, over all entries and channels; 0 of none.
double rms_grey(const std::vector<float>& a, const std::vector<float>& b);
double rms_grey(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);

// Pixels of the whole picture a second, in millions.
double mpixels_per_s(const GBuffer& buffer, double ms);

}  // namespace dfield::cli
