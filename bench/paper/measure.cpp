#include "bench/paper/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "baker/cli/embree_peer.hpp"
#include "format/frame.hpp"

namespace dfield::paper {
namespace {

// Modes this much slower than the fastest in the first round do not come back.
constexpr double kHopeless = 1.3;

std::vector<cli::PeerRay> rays_of(const Receivers& receivers, const Directions& directions) {
    std::vector<cli::PeerRay> rays;
    rays.reserve(receivers.size() * directions.directions.size());
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const Frame frame = frame_of_normal(receivers.normals[i]);
        for (const glm::vec3& direction : directions.directions)
            rays.push_back({receivers.positions[i], frame.to_world(direction)});
    }
    return rays;
}

}  // namespace

Errors errors_of(const std::vector<float>& visibility, const std::vector<float>& reference) {
    Errors errors;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        const double error = 255.0 * (static_cast<double>(visibility[i]) - reference[i]);
        errors.rms += error * error;
        errors.bias += error;
        errors.max = std::max(errors.max, std::fabs(error));
    }
    errors.rms = std::sqrt(errors.rms / static_cast<double>(visibility.size()));
    errors.bias /= static_cast<double>(visibility.size());
    return errors;
}

Lookup::Lookup(std::span<const std::byte> field, const Receivers& receivers, const Directions& directions,
               float reach)
    : receivers_(receivers),
      field_(Field::load(context_.get(), field.data(), field.size())),
      scene_(context_.get()),
      visibility_(receivers.size()) {
    const glm::mat4 identity(1);
    scene_.add(field_, &identity[0][0]);
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = static_cast<std::uint32_t>(directions.directions.size());
    desc.directions = &directions.directions.front().x;
    desc.weights = directions.weights.empty() ? nullptr : directions.weights.data();
    if (reach < kUnbounded) {
        desc.max_distance = reach;
        desc.falloff = DFIELD_FALLOFF_LINEAR;
    }
    ao_ = std::make_unique<Ao>(context_.get(), desc);
}

double Lookup::run() {
    const auto start = std::chrono::steady_clock::now();
    scene_.visibility(*ao_, receivers_.view(), visibility_.data());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double Lookup::fastest_run(int rounds) {
    double best = run();
    for (int round = 1; round < rounds; ++round) best = std::min(best, run());
    return best;
}

Duel duel(const TriangleMesh& caster, std::span<const std::byte> field, const Receivers& receivers,
          const Directions& directions, int rounds) {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(caster);
    scene.commit();
    Lookup lookup(field, receivers, directions);
    const std::vector<cli::PeerRay> rays = rays_of(receivers, directions);

    Duel result;
    result.rays = rays.size();
    result.lookup_seconds = result.embree_seconds = std::numeric_limits<double>::infinity();
    std::map<std::string, double> first;  // seconds of each mode in the first round
    std::vector<std::uint8_t> occluded;
    for (int round = 0; round < rounds; ++round) {
        const double hopeless = kHopeless * result.embree_seconds;
        for (const cli::EmbreeMode& mode : cli::embree_modes(false)) {
            if (round > 0 && first[mode.name()] > hopeless) continue;
            const double seconds = cli::time_occluded(scene, rays, mode, 1, 1, occluded);
            first.emplace(mode.name(), seconds);
            if (seconds < result.embree_seconds) {
                result.embree_seconds = seconds;
                result.embree_mode = mode.name();
            }
        }
        result.lookup_seconds = std::min(result.lookup_seconds, lookup.run());
    }
    return result;
}

}  // namespace dfield::paper
