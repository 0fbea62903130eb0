#include "bench/kinds/contest.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "format/frame.hpp"

namespace dfield::kinds {
namespace {

constexpr double kHopeless = 1.3;
constexpr std::size_t kReceiversAChunk = 4096;  // a million rays: prepared packets then take some 50 MB

}  // namespace

std::vector<cli::PeerRay> Pairs::rays(const paper::Receivers& receivers, std::size_t begin, std::size_t end,
                                      std::vector<std::uint32_t>& counts) const {
    std::vector<cli::PeerRay> result;
    result.reserve((end - begin) * directions.size());
    counts.clear();
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t before = result.size();
        const glm::vec3 &position = receivers.positions[i], &normal = receivers.normals[i];
        const Frame frame = frame_of_normal(normal);
        for (const glm::vec3& direction : directions) {
            if (sampling == DFIELD_SAMPLING_HEMISPHERE)
                result.push_back({position, frame.to_world(direction)});
            else if (glm::dot(normal, direction) > 0)
                result.push_back({position, direction});
        }
        counts.push_back(static_cast<std::uint32_t>(result.size() - before));
    }
    return result;
}

dfield_ao_desc Pairs::desc(dfield_kind kind) const {
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = static_cast<std::uint32_t>(directions.size());
    desc.directions = &directions.front().x;
    desc.sampling = sampling;
    desc.kind = kind;
    return desc;
}

void Pairs::gather(const paper::Receivers& receivers, std::size_t begin, std::size_t end,
                   std::span<const std::uint8_t> occluded, std::vector<float>& visibility) const {
    std::size_t ray = 0;
    for (std::size_t i = begin; i < end; ++i) {
        double open = 0, all = 0;
        for (const glm::vec3& direction : directions) {
            double weight = 1;
            if (sampling == DFIELD_SAMPLING_SHARED) {
                weight = glm::dot(receivers.normals[i], direction);
                if (!(weight > 0)) continue;
            }
            all += weight;
            if (!occluded[ray++]) open += weight;
        }
        visibility.push_back(static_cast<float>(open / all));
    }
}

Pairs hemisphere_pairs(const paper::Lab& lab) {
    return {DFIELD_SAMPLING_HEMISPHERE, lab.directions(paper::Rays::kConcentric).directions};
}

Pairs shared_pairs(const paper::Lab& lab) {
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = DFIELD_SAMPLING_SHARED;
    desc.ray_count = lab.quick() ? kSharedDirections / 8 : kSharedDirections;
    const Context context;
    const Ao ao(context, desc);
    Pairs pairs{DFIELD_SAMPLING_SHARED, {}};
    for (std::uint32_t i = 0; i < desc.ray_count; ++i)
        pairs.directions.emplace_back(ao.directions()[3 * i], ao.directions()[3 * i + 1],
                                      ao.directions()[3 * i + 2]);
    return pairs;
}

double seconds_of(const std::function<void()>& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

EmbreeContest::EmbreeContest(const EmbreeScene& scene, const paper::Receivers& receivers, const Pairs& pairs,
                             bool instanced)
    : scene_(scene), receivers_(receivers), pairs_(pairs), seconds_(std::numeric_limits<double>::infinity()) {
    for (const cli::EmbreeMode& mode : cli::embree_modes(instanced)) modes_.emplace_back(mode, seconds_);
    if (receivers.size() > kReceiversAChunk) choose_by_first_chunk();
    rays_ = 0;
    time_mode(cli::embree_modes(true).front(), &visibility_);
}

double EmbreeContest::time_mode(const cli::EmbreeMode& mode, std::vector<float>* visibility) {
    double seconds = 0;
    std::vector<std::uint32_t> counts;
    std::vector<std::uint8_t> occluded;
    for (std::size_t begin = 0; begin < receivers_.size(); begin += kReceiversAChunk) {
        const std::size_t end = std::min(begin + kReceiversAChunk, receivers_.size());
        const std::vector<cli::PeerRay> rays = pairs_.rays(receivers_, begin, end, counts);
        seconds += cli::time_occluded(scene_, rays, mode, 1, 1, occluded);
        if (!visibility) continue;
        rays_ += rays.size();
        pairs_.gather(receivers_, begin, end, occluded, *visibility);
    }
    return seconds;
}

void EmbreeContest::choose_by_first_chunk() {
    // From the middle: the edges of a ground see little.
    const std::size_t begin = (receivers_.size() - kReceiversAChunk) / 2;
    std::vector<std::uint32_t> counts;
    std::vector<std::uint8_t> occluded;
    const std::vector<cli::PeerRay> rays = pairs_.rays(receivers_, begin, begin + kReceiversAChunk, counts);
    double best = std::numeric_limits<double>::infinity();
    cli::EmbreeMode chosen = modes_.front().first;
    for (const auto& [mode, unused] : modes_) {
        const double seconds = cli::time_occluded(scene_, rays, mode, 1, 2, occluded);
        if (seconds < best) best = seconds, chosen = mode;
    }
    modes_ = {{chosen, seconds_}};
}

void EmbreeContest::turn() {
    const double hopeless = kHopeless * seconds_;
    for (auto& [mode, best] : modes_) {
        if (std::isfinite(best) && best > hopeless) continue;
        best = std::min(best, time_mode(mode, nullptr));
        if (best < seconds_) seconds_ = best, mode_ = mode.name();
    }
}

Context capped_context(dfield_simd cap) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = cap;
    return Context(&desc);
}

const char* simd_name(dfield_simd simd) {
    switch (simd) {
        case DFIELD_SIMD_SCALAR:
            return "scalar";
        case DFIELD_SIMD_SSE4:
            return "SSE4";
        case DFIELD_SIMD_AVX2:
            return "AVX2";
        case DFIELD_SIMD_AVX512:
            return "AVX-512";
        case DFIELD_SIMD_NEON:
            return "NEON";
        default:
            return "best";
    }
}

}  // namespace dfield::kinds
