#include "baker/cli/screen_far.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "baker/bake.hpp"
#include "baker/cli/arguments.hpp"
#include "baker/cli/field_store.hpp"
#include "baker/cli/screen_options.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield::cli {
namespace {

Field load_field(const Context& context, const std::vector<std::byte>& bytes, const std::string& name) {
    try {
        return Field::load(context, bytes.data(), bytes.size());
    } catch (const Exception& error) {
        throw InputError(name + ": " + error.what());
    }
}

// Fields where they stand, and how far apart anything in them is.
struct Casters {
    explicit Casters(const Context& context) : scene(context) {}

    Scene scene;
    Bounds bounds;
    bool any = false;

    // Of the imported scene's instances; DFIELD_NO_INSTANCE for those that do not cast.
    std::vector<dfield_instance> ids;

    void add(const Field& field, const glm::mat4& transform) {
        ids.push_back(scene.add(field, &transform[0][0]));
        const dfield_field_info info = field.info();
        for (int corner = 0; corner < 8; ++corner) {
            glm::vec4 point(0, 0, 0, 1);
            for (int axis = 0; axis < 3; ++axis)
                point[axis] = corner >> axis & 1 ? info.bounds_max[axis] : info.bounds_min[axis];
            grow(glm::vec3(transform * point));
        }
    }
    void grow(const glm::vec3& point) {
        bounds.min = any ? glm::min(bounds.min, point) : point;
        bounds.max = any ? glm::max(bounds.max, point) : point;
        any = true;
    }
};

void add_file(Casters& casters, const FarOptions& options, const Context& context) {
    casters.add(load_field(context, read_file(options.field), options.field), glm::mat4(1));
}

void add_meshes(Casters& casters, const FarOptions& options, const ImportedScene& scene,
                const Context& context, const CommonOptions& common) {
    std::map<std::uint32_t, Field> fields;
    const FieldPlan plan{.maps = options.parameters};
    for (const SceneInstance& instance : scene.instances) {
        const SceneMesh& mesh = scene.meshes[instance.mesh];
        if (!casts(mesh.mesh, instance.transform)) {
            casters.ids.push_back(DFIELD_NO_INSTANCE);
            continue;
        }
        if (!fields.contains(instance.mesh)) {
            ProgressBar progress("baking " + mesh.name, "ray", common.quiet);
            BakeOptions bake;
            bake.threads = common.threads;
            bake.cancel = &interrupted;
            bake.progress = [&](std::uint64_t done, std::uint64_t total) { progress.update(done, total); };
            const BakedField baked = cached_field(mesh.mesh, plan, bake,
                                                  options.no_cache ? std::filesystem::path() : options.cache);
            fields.emplace(instance.mesh, load_field(context, baked.bytes, mesh.name));
        }
        casters.add(fields.at(instance.mesh), instance.transform);
    }
}

// Visibility of a hit by distance, 1 - mu, at even steps to max_distance: steps of R / 256 or less where
// 65,536 of them reach.
std::vector<float> far_table(const FuzzyMeasure& measure, double max_distance) {
    constexpr double kStepsOfRadius = 256, kMost = 65536;
    const double wanted = measure.radius > 0 ? kStepsOfRadius * max_distance / measure.radius : 2;
    const auto size = static_cast<std::size_t>(std::clamp(wanted, 256.0, kMost));
    std::vector<float> table(size);
    for (std::size_t i = 0; i < size; ++i)
        table[i] = static_cast<float>(
            1 - measure(max_distance * static_cast<double>(i) / static_cast<double>(size - 1)));
    return table;
}

}  // namespace

void add_far_options(CLI::App& command, FarOptions& options) {
    options.cache = default_cache_folder();
    constexpr const char* kGroup = "Occluders beyond the radius";
    command
        .add_option(
            "--field", options.field,
            "Looked up in displacement fields: FILE.dfield of the whole scene (dfield bake SCENE), or "
            "auto: each mesh's, baked where the cache lacks it")
        ->type_name("FILE|auto")
        ->group(kGroup);
    command.add_option("--field-rays", options.rays, "Cosine-weighted rays a pixel")
        ->capture_default_str()
        ->check(CLI::Range(1u, DFIELD_MAX_RAYS))
        ->group(kGroup);
    command
        .add_flag("--field-others", options.others,
                  "auto: objects do not ask their own field, which near their surface is coarse")
        ->group(kGroup);
    command.add_option("--cache", options.cache, "Folder of baked fields")
        ->capture_default_str()
        ->group(kGroup);
    command.add_flag("--no-cache", options.no_cache, "Neither read nor write the cache")->group(kGroup);
}

FarVisibility far_visibility(const FarOptions& options, const ScreenSubject& subject,
                             const ScreenRunner& runner, const dfield_screen_desc& desc,
                             const CommonOptions& common) {
    if (options.others && (options.field != "auto" || subject.instances.empty()))
        throw Error(ExitCode::kUsage, "--field-others goes with a scene and --field auto");
    const Context& context = runner.context();
    Casters casters(context);
    if (options.field != "auto")
        add_file(casters, options, context);
    else if (subject.scene)
        add_meshes(casters, options, *subject.scene, context, common);
    else
        throw Error(ExitCode::kUsage, "--field auto needs a scene: give --scene beside the G-buffer");

    const GBuffer& buffer = runner.buffer();
    const std::vector<std::uint32_t> pixels = surface_pixels(buffer, buffer.pixels());
    Receivers receivers;
    std::vector<dfield_instance> owners;
    const float lift =
        1e-4f * std::max({casters.bounds.size().x, casters.bounds.size().y, casters.bounds.size().z});
    for (const std::uint32_t pixel : pixels) {
        const ScreenPoint point = world_point(buffer, pixel);
        receivers.positions.push_back(point.position + lift * point.normal);
        receivers.normals.push_back(point.normal);
        casters.grow(point.position);
        if (options.others) owners.push_back(casters.ids[subject.instances[pixel]]);
    }

    dfield_ao_desc ao = Ao::defaults();
    ao.ray_count = options.rays;
    ao.kind = DFIELD_KIND_MAPS;
    const auto look_up = [&](std::vector<float>& frame) {
        std::vector<float> values(pixels.size(), 1.0f);
        double ms = 0;
        try {
            const Ao settings(context, ao);
            const auto start = std::chrono::steady_clock::now();
            if (!values.empty()) casters.scene.visibility(settings, receivers.view(owners), values.data());
            ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        } catch (const Exception& error) {
            throw InputError(options.field + ": " + error.what());
        }
        frame.assign(buffer.pixels(), 1.0f);
        for (std::size_t i = 0; i < pixels.size(); ++i) frame[pixels[i]] = values[i];
        return ms;
    };
    FarVisibility far;
    look_up(far.all);
    // No two points of a box are farther apart than its diagonal.
    const double reach = 1.01 * static_cast<double>(glm::length(casters.bounds.size()));
    const FuzzyMeasure measure = measure_of(desc);
    const std::vector<float> table = far_table(measure, std::max(reach, 2 * measure.radius));
    ao.falloff = DFIELD_FALLOFF_TABLE;
    ao.max_distance = static_cast<float>(std::max(reach, 2 * measure.radius));
    ao.falloff_table = table.data();
    ao.falloff_table_size = table.size();
    far.ms = look_up(far.beyond);
    return far;
}

std::vector<float> combined(const std::vector<float>& near, const std::vector<float>& beyond) {
    std::vector<float> values(near.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::max(near[i] + beyond[i] - 1, 0.0f);
    return values;
}

}  // namespace dfield::cli
