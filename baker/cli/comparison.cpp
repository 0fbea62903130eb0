#include "baker/cli/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "baker/cli/embree_peer.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "baker/ray_visibility.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::cli {
namespace {

constexpr std::size_t kRaysAChunk = std::size_t{1} << 20;  // prepared packets then take some 50 MB
constexpr std::size_t kTimedRays = std::size_t{1} << 24;   // larger scenes are timed with fewer repetitions
constexpr std::size_t kConvergedReceivers = 4096;          // an even subset of more
constexpr std::size_t kFlattenedCasters = 8;  // more share one acceleration structure by instancing

// All casters but the owner, on both sides.
struct Opponents {
    EmbreeScene embree{EmbreeUse::kFast};
    std::unique_ptr<Scene> lookup;
};

class Arena {
  public:
    explicit Arena(const ComparisonInput& input) : input_(input), context_(input.threads) {
        for (const auto& bytes : input.fields) {
            fields_.push_back(Field::load(context_.get(), bytes.data(), bytes.size()));
            field_bytes += fields_.back().info().memory_bytes;
            file_bytes += bytes.size();
        }
        dfield_ao_desc desc = Ao::defaults();
        desc.ray_count = static_cast<std::uint32_t>(input.directions.size());
        desc.sampling = input.shared ? DFIELD_SAMPLING_SHARED : DFIELD_SAMPLING_HEMISPHERE;
        desc.kind = input.kind;
        desc.directions = &input.directions.front().x;
        desc.weights = input.weights.empty() ? nullptr : input.weights.data();
        ao_ = std::make_unique<Ao>(context_.get(), desc);
    }

    Opponents& without(std::size_t owner) {
        auto& entry = opponents_[owner];
        if (entry) return *entry;
        entry = std::make_unique<Opponents>();
        entry->lookup = std::make_unique<Scene>(context_.get());
        const bool flatten = input_.casters.size() <= kFlattenedCasters;
        for (std::size_t i = 0; i < input_.casters.size(); ++i) {
            if (i == owner) continue;
            const ComparisonCaster& caster = input_.casters[i];
            entry->lookup->add(fields_[caster.field], &caster.transform[0][0]);
            if (flatten)
                entry->embree.add_mesh(*caster.mesh, caster.transform);
            else
                entry->embree.add_instance(object_scene(*caster.mesh), caster.transform);
        }
        entry->embree.commit(input_.threads);
        return *entry;
    }

    const Ao& ao() const { return *ao_; }

    // Whether it can be told which rays are blocked.
    bool knows_rays() const {
        return std::none_of(fields_.begin(), fields_.end(),
                            [&](const Field& field) { return ao_->kind(field) == DFIELD_KIND_VOLUME; });
    }

    // The kind that answers; "mixed" where fields differ.
    std::string kind() const {
        std::string result;
        for (const Field& field : fields_) {
            const std::string name = name_of(ao_->kind(field));
            result = result.empty() || result == name ? name : "mixed";
        }
        return result;
    }

    // Spheres of all casters but the owner, as the maps from world space to the unit sphere.
    std::vector<glm::mat4> unit_spheres(std::size_t owner) const {
        std::vector<glm::mat4> result;
        for (std::size_t i = 0; i < input_.casters.size(); ++i) {
            if (i == owner) continue;
            const dfield_field_info info = fields_[input_.casters[i].field].info();
            glm::mat4 sphere(info.radius);
            sphere[3] = {info.centre[0], info.centre[1], info.centre[2], 1};
            result.push_back(glm::inverse(input_.casters[i].transform * sphere));
        }
        return result;
    }

    std::uint64_t field_bytes = 0, file_bytes = 0;

  private:
    const EmbreeScene& object_scene(const TriangleMesh& mesh) {
        auto& scene = objects_[&mesh];
        if (!scene) {
            scene = std::make_unique<EmbreeScene>(EmbreeUse::kFast);
            scene->add_mesh(mesh);
            scene->commit(input_.threads);
        }
        return *scene;
    }

    const ComparisonInput& input_;
    ThreadedContext context_;
    std::vector<Field> fields_;
    std::unique_ptr<Ao> ao_;
    std::map<const TriangleMesh*, std::unique_ptr<EmbreeScene>> objects_;
    std::map<std::size_t, std::unique_ptr<Opponents>> opponents_;
};

// Calls visit(i, r, direction, weight) for the rays of receivers [begin, end) in order: ray r of receiver i.
template<class Visit>
void for_rays(const ComparisonInput& input, const Receivers& receivers, std::size_t begin, std::size_t end,
              const Visit& visit) {
    const double even = 1.0 / static_cast<double>(input.directions.size());
    for (std::size_t i = begin; i < end; ++i) {
        const glm::vec3& normal = receivers.normals[i];
        const Frame frame = frame_of_normal(normal);
        for (std::size_t r = 0; r < input.directions.size(); ++r) {
            const glm::vec3& w = input.directions[r];
            if (!input.shared)
                visit(i, r, frame.to_world(w), input.weights.empty() ? even : input.weights[r]);
            else if (const float cosine = glm::dot(normal, w); cosine > 0)
                visit(i, r, w, cosine);
        }
    }
}

std::vector<PeerRay> rays_of(const ComparisonInput& input, const Receivers& receivers, std::size_t begin,
                             std::size_t end) {
    std::vector<PeerRay> rays;
    rays.reserve((end - begin) * input.directions.size());
    for_rays(input, receivers, begin, end, [&](std::size_t i, std::size_t, const glm::vec3& w, double) {
        rays.push_back({receivers.positions[i], w});
    });
    return rays;
}

bool meets_unit_sphere(const glm::mat4& to_unit, const PeerRay& ray) {
    const glm::vec3 o(to_unit * glm::vec4(ray.origin, 1)), d(to_unit * glm::vec4(ray.direction, 0));
    const float approach = glm::dot(o, d), outside = glm::dot(o, o) - 1;
    return outside <= 0 || (approach < 0 && approach * approach > glm::dot(d, d) * outside);
}

template<class Run>
double fastest(int repetitions, const Run& run) {
    double best = std::numeric_limits<double>::infinity();
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        const auto start = std::chrono::steady_clock::now();
        run();
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

dfield_rays ray_view(const std::vector<PeerRay>& rays) {
    dfield_rays view{};
    view.count = rays.size();
    view.origins = &rays.front().origin.x;
    view.directions = &rays.front().direction.x;
    view.origin_stride = view.direction_stride = sizeof(PeerRay);
    return view;
}

// The fastest of Embree's modes on one chunk of the rays.
EmbreeMode choose_mode(const EmbreeScene& scene, const std::vector<PeerRay>& rays,
                       const ComparisonInput& input, Comparison& result) {
    const std::span<const EmbreeMode> modes = embree_modes(input.casters.size() > kFlattenedCasters);
    EmbreeMode best = modes.front();
    double best_rate = 0;
    std::vector<std::uint8_t> occluded;
    for (const EmbreeMode& mode : modes) {
        const double seconds = time_occluded(scene, rays, mode, input.threads, 3, occluded);
        const double rate = static_cast<double>(rays.size()) / seconds * 1e-6;
        result.embree_modes.emplace_back(mode.name(), rate);
        if (rate > best_rate) best = mode, best_rate = rate;
    }
    result.embree_mode = best.name();
    return best;
}

struct Totals {
    std::size_t disagreeing = 0, sphere_rays = 0;
    double lookup_sphere_seconds = 0, embree_sphere_seconds = 0;
};

// Timings and per-ray results of receivers [begin, end) of a group; appends to result.lookup and
// result.reference.
void compare_chunk(const ComparisonInput& input, Arena& arena, const ReceiverGroup& group, std::size_t begin,
                   std::size_t end, const EmbreeMode& mode, Comparison& result, Totals& totals) {
    Opponents& opponents = arena.without(group.owner);
    const std::size_t count = end - begin;
    dfield_receivers receivers = group.receivers.view();
    receivers.count = count;
    receivers.positions += 3 * begin;
    receivers.normals += 3 * begin;

    std::vector<float> visibility(count);
    result.lookup_seconds += fastest(
        input.repetitions, [&] { opponents.lookup->visibility(arena.ao(), receivers, visibility.data()); });
    result.lookup.insert(result.lookup.end(), visibility.begin(), visibility.end());

    const std::vector<PeerRay> rays = rays_of(input, group.receivers, begin, end);
    std::vector<std::uint8_t> occluded;
    result.embree_seconds +=
        time_occluded(opponents.embree, rays, mode, input.threads, input.repetitions, occluded);
    // Errors are against one mode, whichever was fastest: along edges the modes differ in a few rays.
    time_occluded(opponents.embree, rays, embree_modes(true).front(), input.threads, 1, occluded);

    const std::size_t words = dfield_ao_get_mask_words(arena.ao().get());
    std::vector<std::uint32_t> masks;
    if (arena.knows_rays()) {
        masks.resize(count * words);
        opponents.lookup->visibility_mask(arena.ao(), receivers, masks.data());
    }
    std::vector<double> blocked(count), whole(count);
    std::size_t ray = 0;
    for_rays(input, group.receivers, begin, end,
             [&](std::size_t i, std::size_t r, const glm::vec3&, double weight) {
                 const bool hit = occluded[ray++] != 0;
                 if (!masks.empty())
                     totals.disagreeing +=
                         hit != ((masks[(i - begin) * words + (r >> 5)] >> (r & 31) & 1) != 0);
                 if (hit) blocked[i - begin] += weight;
                 whole[i - begin] += weight;
             });
    for (std::size_t i = 0; i < count; ++i)
        result.reference.push_back(
            static_cast<float>(std::clamp(1 - (whole[i] > 0 ? blocked[i] / whole[i] : 0), 0.0, 1.0)));
    result.rays += rays.size();

    std::vector<PeerRay> meeting;
    const std::vector<glm::mat4> spheres = arena.unit_spheres(group.owner);
    std::copy_if(rays.begin(), rays.end(), std::back_inserter(meeting), [&](const PeerRay& ray) {
        return std::any_of(spheres.begin(), spheres.end(),
                           [&](const glm::mat4& to_unit) { return meets_unit_sphere(to_unit, ray); });
    });
    totals.sphere_rays += meeting.size();
    if (meeting.empty() || input.shared || !arena.knows_rays()) return;  // no question for these
    totals.embree_sphere_seconds +=
        time_occluded(opponents.embree, meeting, mode, input.threads, input.repetitions, occluded);
    std::vector<std::uint8_t> answers(meeting.size());
    totals.lookup_sphere_seconds +=
        fastest(input.repetitions, [&] { opponents.lookup->occluded(ray_view(meeting), answers.data()); });
}

// The error against many rays, at an even subset of a group's receivers. `lookup` holds the group's values.
struct ConvergedError {
    double squares = 0;
    std::size_t receivers = 0;

    void add(const EmbreeScene& scene, const Receivers& group, const float* lookup, std::size_t all,
             const std::vector<glm::vec3>& directions) {
        const std::size_t stride = std::max<std::size_t>(1, all / kConvergedReceivers);
        std::vector<glm::vec3> positions, normals;
        std::vector<float> looked_up;
        for (std::size_t i = 0; i < group.size(); i += stride) {
            positions.push_back(group.positions[i]);
            normals.push_back(group.normals[i]);
            looked_up.push_back(lookup[i]);
        }
        RayVisibilityOptions options;
        options.directions = directions;
        options.cancel = &interrupted;
        const std::vector<float> values = ray_visibility(scene, positions, normals, options);
        for (std::size_t i = 0; i < values.size(); ++i)
            squares += std::pow(255.0 * (static_cast<double>(looked_up[i]) - values[i]), 2);
        receivers += values.size();
    }
    double rms() const { return receivers ? std::sqrt(squares / static_cast<double>(receivers)) : 0; }
};

void set_errors(Comparison& result) {
    const auto n = static_cast<double>(result.lookup.size());
    std::vector<double> errors;
    for (std::size_t i = 0; i < result.lookup.size(); ++i) {
        const double error = 255.0 * (static_cast<double>(result.lookup[i]) - result.reference[i]);
        result.rms_grey += error * error / n;
        result.bias_grey += error / n;
        errors.push_back(std::fabs(error));
    }
    result.rms_grey = std::sqrt(result.rms_grey);
    std::sort(errors.begin(), errors.end());
    const auto percentile = [&](double p) { return errors[static_cast<std::size_t>(p * (n - 1))]; };
    result.max_grey = errors.back();
    result.percentile_50 = percentile(0.50);
    result.percentile_90 = percentile(0.90);
    result.percentile_95 = percentile(0.95);
    result.percentile_99 = percentile(0.99);
}

}  // namespace

Comparison compare(const ComparisonInput& given) {
    ComparisonInput input = given;
    std::size_t receivers = 0;
    for (const ReceiverGroup& group : input.groups) receivers += group.receivers.size();
    if (receivers == 0) throw InputError("the scene has no vertices to compare at");
    const std::size_t ray_count = input.directions.size();
    input.repetitions =
        std::clamp(static_cast<int>(kTimedRays / (receivers * ray_count)), 1, std::max(input.repetitions, 1));

    Comparison result;
    Arena arena(input);
    result.field_bytes = arena.field_bytes;
    result.file_bytes = arena.file_bytes;
    const std::size_t chunk = std::max<std::size_t>(1, kRaysAChunk / ray_count);
    const std::vector<glm::vec3> many = cosine_directions(input.converged_rays);

    Totals totals;
    EmbreeMode mode{};
    ConvergedError converged;
    for (const ReceiverGroup& group : input.groups) {
        const std::size_t first = result.lookup.size();
        const EmbreeScene& peer = arena.without(group.owner).embree;
        for (std::size_t begin = 0; begin < group.receivers.size(); begin += chunk) {
            if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted");
            const std::size_t end = std::min(begin + chunk, group.receivers.size());
            if (result.embree_mode.empty())
                mode = choose_mode(peer, rays_of(input, group.receivers, begin, end), input, result);
            compare_chunk(input, arena, group, begin, end, mode, result, totals);
        }
        converged.add(peer, group.receivers, result.lookup.data() + first, receivers, many);
    }

    result.receivers = result.lookup.size();
    result.kind = arena.kind();
    result.knows_rays = arena.knows_rays();
    result.rays_per_receiver = ray_count;
    const auto all = static_cast<double>(result.rays);
    set_errors(result);
    result.rms_grey_converged = converged.rms();
    result.disagree_fraction = static_cast<double>(totals.disagreeing) / all;
    result.sphere_hit_fraction = static_cast<double>(totals.sphere_rays) / all;
    result.lookup_mrays_per_s = all / result.lookup_seconds * 1e-6;
    result.embree_mrays_per_s = all / result.embree_seconds * 1e-6;
    result.speedup = result.embree_seconds / result.lookup_seconds;
    result.speedup_sphere_hits =
        totals.lookup_sphere_seconds > 0 ? totals.embree_sphere_seconds / totals.lookup_sphere_seconds : 0;
    return result;
}

Json Comparison::json() const {
    Json json;
    json["kind"] = kind;
    json["rays"] = rays;
    json["rays_per_receiver"] = rays_per_receiver;
    json["receivers"] = receivers;
    json["rms_grey"] = significant(rms_grey);
    json["bias_grey"] = significant(bias_grey);
    json["max_grey"] = significant(max_grey);
    json["percentiles_grey"] = {{"50", significant(percentile_50)},
                                {"90", significant(percentile_90)},
                                {"95", significant(percentile_95)},
                                {"99", significant(percentile_99)}};
    json["rms_grey_converged"] = significant(rms_grey_converged);
    if (knows_rays) json["disagree_fraction"] = significant(disagree_fraction);
    json["sphere_hit_fraction"] = significant(sphere_hit_fraction);
    json["lookup_seconds"] = significant(lookup_seconds);
    json["embree_seconds"] = significant(embree_seconds);
    json["ns_per_receiver"] = significant(lookup_seconds * 1e9 / static_cast<double>(receivers));
    json["lookup_mrays_per_s"] = significant(lookup_mrays_per_s);
    json["embree_mrays_per_s"] = significant(embree_mrays_per_s);
    json["embree_mode"] = embree_mode;
    Json modes;
    for (const auto& [name, rate] : embree_modes) modes[name] = significant(rate);
    json["embree_modes_mrays_per_s"] = modes;
    json["speedup"] = significant(speedup);
    if (speedup_sphere_hits > 0) json["speedup_sphere_hits"] = significant(speedup_sphere_hits);
    json["field_bytes"] = field_bytes;
    json["file_bytes"] = file_bytes;
    return json;
}

}  // namespace dfield::cli
