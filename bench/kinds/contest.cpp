#include "bench/kinds/contest.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "format/frame.hpp"

namespace dfield::kinds {
namespace {

constexpr double kHopeless = 1.3;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::size_t kManyParts = 64;  // with more, the mode is settled on so many of them

}  // namespace

std::vector<cli::PeerRay> Pairs::rays(const paper::Receivers& receivers, std::size_t begin,
                                      std::size_t end) const {
    std::vector<cli::PeerRay> result;
    result.reserve((end - begin) * directions.size());
    for (std::size_t i = begin; i < end; ++i) {
        const glm::vec3 &position = receivers.positions[i], &normal = receivers.normals[i];
        const Frame frame = frame_of_normal(normal);
        for (const glm::vec3& direction : directions) {
            if (sampling == DFIELD_SAMPLING_HEMISPHERE)
                result.push_back({position, frame.to_world(direction)});
            else if (glm::dot(normal, direction) > 0)
                result.push_back({position, direction});
        }
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

EmbreeContest::EmbreeContest(const EmbreeScene& scene, const paper::Receivers& receivers, const Pairs& pairs,
                             bool instanced)
    : scene_(scene), receivers_(receivers), pairs_(pairs), seconds_(kNever) {
    const std::size_t parts = (receivers.size() + kReceiversAPart - 1) / kReceiversAPart;
    for (const cli::EmbreeMode& mode : cli::embree_modes(instanced))
        modes_.push_back({mode, std::vector<double>(parts, kNever)});
    Mode reference = modes_.front();
    time_parts(reference, 1, &visibility_);
    if (parts <= kManyParts) return;
    for (int turn = 0; turn < 2; ++turn)
        for (Mode& mode : modes_) time_parts(mode, parts / kManyParts);
    const auto fastest = std::min_element(modes_.begin(), modes_.end(), [&](const Mode& a, const Mode& b) {
        return a.seconds() < b.seconds();
    });
    modes_ = {{fastest->mode, std::vector<double>(parts, kNever)}};
}

double EmbreeContest::Mode::seconds() const {
    // Parts that were not measured do not count: the others stand for them on all sides.
    return std::accumulate(parts.begin(), parts.end(), 0.0,
                           [](double sum, double part) { return std::isfinite(part) ? sum + part : sum; });
}

void EmbreeContest::time_parts(Mode& mode, std::size_t step, std::vector<float>* visibility) {
    std::vector<std::uint8_t> occluded;
    for (std::size_t part = 0; part < mode.parts.size(); part += step) {
        const std::size_t begin = part * kReceiversAPart,
                          end = std::min(begin + kReceiversAPart, receivers_.size());
        const std::vector<cli::PeerRay> rays = pairs_.rays(receivers_, begin, end);
        mode.parts[part] =
            std::min(mode.parts[part], cli::time_occluded(scene_, rays, mode.mode, 1, 1, occluded));
        if (!visibility) continue;
        rays_ += rays.size();
        pairs_.gather(receivers_, begin, end, occluded, *visibility);
    }
}

void EmbreeContest::turn() {
    const double hopeless = kHopeless * seconds_;
    for (Mode& mode : modes_) {
        if (std::isfinite(mode.parts.front()) && mode.seconds() > hopeless) continue;
        time_parts(mode, 1);
        if (mode.seconds() <= seconds_) seconds_ = mode.seconds(), mode_ = mode.mode.name();
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
