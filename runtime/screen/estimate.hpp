// The estimators as a job: raw values of the pixels of some rows, before the filter.
#pragma once

#include <cstdint>
#include <optional>

#include "screen/frame.hpp"
#include "screen/measure.hpp"
#include "screen/points.hpp"
#include "screen/samples.hpp"

namespace dfield::runtime::screen {

// A column of the disk of radius 1, and the inverse of the density it has been chosen with: 1, or 1 - rho^2.
struct DiskSample {
    float x, y, weight;
};

// What a dfield_screen does, checked.
struct Settings {
    dfield_screen_desc desc;
    Measure measure;

    explicit Settings(const dfield_screen_desc* given);
    bool ratio() const { return desc.weights == DFIELD_WEIGHTS_RATIO; }
    bool disk() const { return desc.estimator == DFIELD_ESTIMATOR_DISK; }
    SampleSets<DiskSample> disk_sets(std::pmr::memory_resource* memory) const;
};

// Sums over a pixel's samples.
struct Estimate {
    float seen = 0, open = 0;  // O is their quotient; 1 where `open` is 0
    glm::vec3 radiance{0};
    float radiance_weight = 0;
};

struct EstimateJob {
    const Frame* frame = nullptr;
    const Settings* settings = nullptr;
    const SampleSets<DiskSample>* disk = nullptr;  // DISK's
    const PointSets* points = nullptr;             // the others'
    bool indirect = false;
    // Out, planes of frame->layout.
    float* visibility = nullptr;
    float* light = nullptr;  // indirect: four after each other, sums of radiance and of their weights
    float* slopes =
        nullptr;  // two: the tangent plane's depth from pixel to pixel along rows and columns. May be null
};

// The pattern that a disk's samples are spread over: a circle around s, in pixels. Its radius is that of the
// sphere across the ray of sight, rounded up to one of four sizes an octave, so that pixels side by side
// share it: what lies outside the sphere has no volume. Samples are moved to pixels' centres.
struct Pattern {
    static constexpr float kMost = 0x1p20f;
    static constexpr unsigned kDropped = 21;  // of a float's 23 bits

    explicit Pattern(const Shaded& s) : Pattern(reach_of(s), s.pixel_x / s.pixel_y) {}
    Pattern(float reach, float aspect) {
        const auto bits = std::bit_cast<std::uint32_t>(std::clamp(reach, 0.5f, kMost));
        radius_x = std::bit_cast<float>((bits + (1u << kDropped) - 1) >> kDropped << kDropped);
        radius_y = radius_x * aspect;
    }
    float columns(const DiskSample& sample) const { return std::floor(sample.x * radius_x + 0.5f); }
    float rows(const DiskSample& sample) const { return std::floor(0.5f - sample.y * radius_y); }

    float radius_x, radius_y;
};

// The weight of darkness in a sample's average radiance: nothing else would be stable where all that is seen
// lies in the tangent plane, give or take a bit.
constexpr float kDarkness = 1e-4f;

// Adds the radiance of a pixel that was looked up.
void add_radiance(const EstimateJob& job, const Shaded& s, const Seen& seen, Estimate& sum);

// A row, as the paper has it: what the vectorised forms are held against, and what contexts capped at
// DFIELD_SIMD_SCALAR run.
void estimate_reference(const EstimateJob& job, std::int32_t row);

}  // namespace dfield::runtime::screen
