#include "baker/cli/scene_visibility.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/matrix.hpp>
#include <map>
#include <memory>

#include "baker/bake.hpp"
#include "baker/bounding_sphere.hpp"
#include "baker/cli/field_store.hpp"
#include "baker/cli/runtime_scene.hpp"
#include "baker/cli/self_masks.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "baker/ray_visibility.hpp"

namespace dfield::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_interrupt() {
    if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
}

// Rotation, translation, mirroring and one scale: angles stay, so occlusion of an object by itself stays too.
bool keeps_angles(const glm::mat4& m) {
    const glm::mat3 linear(m);
    const glm::mat3 gram = glm::transpose(linear) * linear;
    const float scale = gram[0][0];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (std::fabs(gram[i][j] - (i == j ? scale : 0)) > 1e-4f * scale) return false;
    return true;
}

class Job {
  public:
    Job(const ImportedScene& scene, const SceneVisibilityOptions& options)
        : scene_(scene), options_(options), context_(options.threads), ao_(context_.get(), options.ao) {
        directions_.resize(options.ao.ray_count);
        for (std::size_t r = 0; r < directions_.size(); ++r)
            directions_[r] = {ao_.directions()[3 * r], ao_.directions()[3 * r + 1],
                              ao_.directions()[3 * r + 2]};
        for (const SceneInstance& instance : scene.instances) {
            const TriangleMesh& mesh = scene.meshes[instance.mesh].mesh;
            Receivers& receivers = receivers_.emplace_back(placed_vertices(mesh, instance.transform));
            // What stands on another object touches it: whether that is hit at distance 0 would be chance.
            const std::vector<glm::vec3> origins = vertex_ray_origins(mesh);
            for (std::size_t i = 0; i < origins.size(); ++i)
                receivers.positions[i] = glm::vec3(instance.transform * glm::vec4(origins[i], 1));
        }
    }

    SceneVisibility by_lookup() {
        dfield::Scene lookup(context_.get());
        add_casters(lookup);
        if (!options_.ground.empty()) lookup.set_ground(options_.ground.data());
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            check_interrupt();
            result_.values.push_back(unites_masks() ? united_visibility(lookup, i)
                                                    : multiplied_visibility(lookup, i));
        }
        return finish();
    }

    SceneVisibility by_rays() {
        std::unique_ptr<EmbreeScene> whole;
        if (options_.self) whole = casters_without(scene_.instances.size());
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            check_interrupt();
            const auto start = Clock::now();
            const std::unique_ptr<EmbreeScene> others = options_.self ? nullptr : casters_without(i);
            RayVisibilityOptions rays = ray_options();
            rays.ground = options_.ground;
            result_.values.push_back(ray_visibility(options_.self ? *whole : *others, receivers_[i].positions,
                                                    receivers_[i].normals, rays));
            result_.visibility_seconds += seconds_since(start);
        }
        return finish();
    }

  private:
    bool casts(std::size_t instance) const {
        return cli::casts(mesh_of(instance), scene_.instances[instance].transform);
    }

    // Masks of the same rays, of the object itself and of the others, unite exactly.
    bool unites_masks() const {
        return options_.self && shared() && options_.ao.falloff == DFIELD_FALLOFF_NONE && self_is_unbounded();
    }

    bool shared() const { return options_.ao.sampling == DFIELD_SAMPLING_SHARED; }

    // Neither distances nor even scale change what an object hides of itself.
    bool self_is_unbounded() const {
        return !std::isfinite(options_.ao.max_distance) && options_.ao.bias == 0;
    }

    std::vector<float> united_visibility(const dfield::Scene& lookup, std::size_t i) {
        const Receivers& receivers = receivers_[i];
        std::vector<float> values(receivers.size(), 1.0f);
        if (values.empty()) return values;
        auto start = Clock::now();
        std::vector<std::uint32_t> self;
        if (casts(i)) self = self_masks_of(i);
        result_.self_seconds += seconds_since(start);

        start = Clock::now();
        const std::vector<dfield_instance> owners(receivers.size(), ids_[i]);
        std::vector<std::uint32_t> masks(receivers.size() * ao_.mask_words());
        lookup.visibility_mask(ao_, receivers.view(owners), masks.data());
        for (std::size_t word = 0; word < self.size(); ++word) masks[word] |= self[word];
        ao_.gather(receivers.view(), masks.data(), nullptr, values.data());
        result_.visibility_seconds += seconds_since(start);
        return values;
    }

    std::vector<float> multiplied_visibility(const dfield::Scene& lookup, std::size_t i) {
        const std::vector<float> self = options_.self ? self_of(i) : std::vector<float>();
        const auto start = Clock::now();
        const std::vector<dfield_instance> owners(receivers_[i].size(), ids_[i]);
        dfield_receivers view = receivers_[i].view(owners);
        view.self_visibility = self.empty() ? nullptr : self.data();
        std::vector<float> values(receivers_[i].size(), 1.0f);
        if (!values.empty()) lookup.visibility(ao_, view, values.data());
        result_.visibility_seconds += seconds_since(start);
        return values;
    }

    std::vector<std::uint32_t> self_masks_of(std::size_t i) {
        const SceneInstance& instance = scene_.instances[i];
        auto& masks = self_masks_[instance.mesh];
        if (!masks) {
            const auto uses =
                std::count_if(scene_.instances.begin(), scene_.instances.end(),
                              [&](const SceneInstance& other) { return other.mesh == instance.mesh; });
            masks = std::make_unique<SelfMasks>(mesh_of(i), static_cast<std::size_t>(uses), options_.threads);
        }
        return masks->of_instance(instance.transform, directions_);
    }

    const TriangleMesh& mesh_of(std::size_t instance) const {
        return scene_.meshes[scene_.instances[instance].mesh].mesh;
    }

    // Self-occlusion is baked with the field where neither distances nor the transform change it.
    bool self_in_field() const { return options_.self && !shared() && self_is_unbounded(); }

    void add_casters(dfield::Scene& lookup) {
        ids_.assign(scene_.instances.size(), DFIELD_NO_INSTANCE);
        // A lone object has nobody to occlude it.
        const bool alone = scene_.instances.size() < 2;
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            const SceneInstance& instance = scene_.instances[i];
            if (!casts(i) || (alone && !self_in_field())) continue;
            if (!fields_.contains(instance.mesh)) fields_.emplace(instance.mesh, bake(instance.mesh));
            ids_[i] = lookup.add(fields_.at(instance.mesh), &instance.transform[0][0]);
        }
    }

    Field bake(std::uint32_t mesh_index) {
        check_interrupt();
        const SceneMesh& mesh = scene_.meshes[mesh_index];
        ProgressBar progress(
            "baking " + (mesh.name.empty() ? "mesh " + std::to_string(mesh_index) : mesh.name), "ray",
            options_.quiet);
        BakeOptions bake;
        bake.threads = options_.threads;
        bake.self_visibility = self_in_field();
        bake.self_rays = options_.ao.ray_count;
        bake.cancel = &interrupted;
        bake.progress = [&](std::uint64_t done, std::uint64_t total) { progress.update(done, total); };
        const auto start = Clock::now();
        const BakedField baked = cached_field(mesh.mesh, options_.plan, bake, options_.cache);
        result_.bake_seconds += seconds_since(start);
        ++(baked.from_cache ? result_.from_cache : result_.baked);
        Field field = Field::load(context_.get(), baked.bytes.data(), baked.bytes.size());
        result_.field_bytes += field.info().memory_bytes;
        result_.kind = name_of(ao_.kind(field));
        return field;
    }

    std::vector<float> self_of(std::size_t i) {
        const SceneInstance& instance = scene_.instances[i];
        if (!casts(i)) return {};
        if (self_in_field() && keeps_angles(instance.transform)) {
            const float* baked = fields_.at(instance.mesh).self_visibility();
            return {baked, baked + receivers_[i].size()};
        }
        const auto start = Clock::now();
        EmbreeScene own(EmbreeUse::kFast);
        own.add_mesh(mesh_of(i), instance.transform);
        own.commit(options_.threads);
        auto values = ray_visibility(own, receivers_[i].positions, receivers_[i].normals, ray_options());
        result_.self_seconds += seconds_since(start);
        return values;
    }

    // Everything but one instance; an index past the end leaves nothing out.
    std::unique_ptr<EmbreeScene> casters_without(std::size_t omitted) {
        auto casters = std::make_unique<EmbreeScene>(EmbreeUse::kFast);
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            if (i == omitted || !casts(i)) continue;
            auto& object = objects_[scene_.instances[i].mesh];
            if (!object) {
                object = std::make_unique<EmbreeScene>(EmbreeUse::kFast);
                object->add_mesh(mesh_of(i));
                object->commit(options_.threads);
            }
            casters->add_instance(*object, scene_.instances[i].transform);
        }
        casters->commit(options_.threads);
        return casters;
    }

    RayVisibilityOptions ray_options() const {
        RayVisibilityOptions rays;
        rays.directions = directions_;
        rays.shared = shared();
        rays.cancel = &interrupted;
        rays.near_distance = options_.ao.bias;
        rays.max_distance = options_.ao.max_distance;
        rays.threads = options_.threads;
        if (options_.ao.falloff != DFIELD_FALLOFF_NONE) {
            rays.occlusion = [](const void* ao, float distance) {
                return dfield_ao_get_occlusion(static_cast<const dfield_ao*>(ao), distance);
            };
            rays.occlusion_data = ao_.get();
        }
        return rays;
    }

    SceneVisibility finish() {
        for (const auto& values : result_.values) result_.vertices += values.size();
        return std::move(result_);
    }

    const ImportedScene& scene_;
    const SceneVisibilityOptions& options_;
    ThreadedContext context_;
    Ao ao_;
    std::vector<glm::vec3> directions_;
    std::vector<Receivers> receivers_;
    std::map<std::uint32_t, Field> fields_;
    std::map<std::uint32_t, std::unique_ptr<EmbreeScene>> objects_;
    std::map<std::uint32_t, std::unique_ptr<SelfMasks>> self_masks_;
    std::vector<dfield_instance> ids_;
    SceneVisibility result_;
};

}  // namespace

SceneVisibility scene_visibility(const ImportedScene& scene, const SceneVisibilityOptions& options) {
    Job job(scene, options);
    return options.method == Method::kLookup ? job.by_lookup() : job.by_rays();
}

}  // namespace dfield::cli
