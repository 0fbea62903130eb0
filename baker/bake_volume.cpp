#include "baker/bake_volume.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "baker/error.hpp"
#include "baker/mesh_distance.hpp"
#include "baker/parallel.hpp"
#include "baker/ray_visibility.hpp"
#include "baker/unit_mesh.hpp"
#include "dfield/dfield.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield {
namespace {

// Everything is in the space where the bounding sphere is the unit sphere.
// Of the grid around the object's box, in longest sides of it; and at least from the box's middle to the
// grid's border, in radii of the bounding sphere: beside a flat object a ball is of no use.
constexpr float kMargin = 0.25f, kLeastReach = 0.6f;
constexpr std::uint32_t kFarSize = 17;
constexpr float kFarNear = 1.6f;  // from where the balls' sizes are right, in radii of the bounding sphere
constexpr std::uint32_t kSilhouette = 64;  // lines along a side
constexpr std::uint32_t kConeRays = 2048;

// Layers of matter outside of the triangles of solids and of what has no inside, in samples. Sweeps take
// matter for opaque from 5/4 of a sample below its surface on, so a layer of 3/4 puts a solid's silhouette in
// its place; a sheet without one would let all light through. What is best depends on the object: leaves
// smaller than a sample want less than walls do. So each is tried.
struct Layers {
    float solid, sheet;
};
constexpr std::array kSolidLayers{0.45f, 0.6f, 0.75f, 0.9f, 1.1f};
constexpr std::array kSheetLayers{0.1f, 0.3f, 0.55f, 0.9f, 1.35f};
constexpr Layers kFirstLayers{0.75f, 0.55f};
constexpr std::size_t kTrials = 512, kTrialRays = 128;  // places and rays of each by which layers are judged
// Samples along a receiver's normal to where lookups read of it (kOffSurface in the runtime).
constexpr float kLookUpAhead = 1.5f;

SampleGrid grid_around(const Bounds& box, std::uint32_t size) {
    const glm::vec3 extent = box.size();
    const float longest = std::max({extent.x, extent.y, extent.z}), margin = kMargin * longest;
    SampleGrid grid;
    grid.spacing = (longest + 2 * margin) / static_cast<float>(size - 1);
    for (int axis = 0; axis < 3; ++axis) {
        const float side = std::max(extent[axis] + 2 * margin, 2 * kLeastReach);
        const float cells = std::ceil(side / grid.spacing - 1e-3f);
        grid.dims[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(cells) + 1;
        grid.origin[axis] = 0.5f * (box.min[axis] + box.max[axis] - cells * grid.spacing);
    }
    return grid;
}

// The object around the samples.
struct Matter {
    std::vector<float> distance;  // to the mesh, as far as the thickest layer asks
    std::vector<std::uint8_t> inside;
    std::vector<std::uint8_t> sheet;  // near triangles beyond which there is no inside

    bool solid = false, open = false;  // has samples inside, and such beside a sheet

    // How far a sample lies within the matter, < 0 outside; right only near the surface, where sweeps read
    // it.
    float depth(std::size_t i, const Layers& layers, float spacing) const {
        const float layer = spacing * (sheet[i] ? layers.sheet : layers.solid);
        return layer + (inside[i] ? distance[i] : -distance[i]);
    }
};

void check_cancel(const VolumeBakeOptions& options) {
    if (options.cancel && options.cancel->load(std::memory_order_relaxed))
        throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
}

Matter matter_around(const EmbreeScene& scene, const TriangleMesh& mesh, const SampleGrid& grid,
                     const VolumeBakeOptions& options) {
    const float thickest = kSheetLayers.back() * grid.spacing, range = thickest + 2 * grid.spacing;
    Matter matter{std::vector<float>(grid.size()),
                  samples_inside(scene, mesh, grid, options.threads, options.cancel),
                  std::vector<std::uint8_t>(grid.size())};
    const auto near_inside = [&](const glm::vec3& point) {
        const glm::vec3 at = (point - grid.origin) / grid.spacing;
        for (std::size_t corner = 0; corner < 8; ++corner) {
            std::array<std::size_t, 3> sample;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float place =
                    std::floor(at[static_cast<int>(axis)]) + static_cast<float>(corner >> axis & 1);
                sample[axis] = static_cast<std::size_t>(
                    glm::clamp(place, 0.0f, static_cast<float>(grid.dims[axis] - 1)));
            }
            if (matter.inside[sample[0] + grid.dims[0] * (sample[1] + grid.dims[1] * sample[2])]) return true;
        }
        return false;
    };
    parallel_ranges(options.threads, grid.size(), 1024, [&](std::size_t begin, std::size_t end) {
        check_cancel(options);
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3 point = grid.point(i);
            const NearestPoint nearest = nearest_point(scene, mesh, point, range);
            matter.distance[i] = nearest.distance;
            if (matter.inside[i] || nearest.distance >= thickest) continue;
            // Half a sample beyond the surface, as seen from here, a solid has an inside.
            const glm::vec3 beyond =
                nearest.distance > 0
                    ? nearest.point + (0.5f * grid.spacing / nearest.distance) * (nearest.point - point)
                    : point;
            matter.sheet[i] = near_inside(beyond) ? 0 : 1;
        }
    });
    const auto some = [](const std::vector<std::uint8_t>& flags) {
        return std::any_of(flags.begin(), flags.end(), [](std::uint8_t flag) { return flag != 0; });
    };
    matter.solid = some(matter.inside);
    matter.open = some(matter.sheet);
    return matter;
}

std::vector<float> depths(const SampleGrid& grid, const Matter& matter, const Layers& layers) {
    std::vector<float> result(grid.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = matter.depth(i, layers, grid.spacing);
    return result;
}

// What each octant of each sample leaves open, as dfield_sweep_outputs has it. By the sweeps' scalar
// reference: the same bytes on every machine.
std::vector<std::uint8_t> swept_octants(const SampleGrid& grid, const std::vector<float>& depth) {
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    hooks.simd = DFIELD_SIMD_SCALAR;
    const Context context(&hooks);
    dfield_volume_samples samples{};
    samples.struct_size = sizeof samples;
    std::copy(grid.dims.begin(), grid.dims.end(), samples.grid.dims);
    std::fill_n(samples.grid.spacing, 3, grid.spacing);
    samples.type = DFIELD_SAMPLE_F32;
    samples.data = depth.data();
    dfield_sweep_desc desc;
    dfield_sweep_desc_init(&desc);
    desc.ordinates = 48;
    std::vector<std::uint8_t> words(8 * grid.size());
    dfield_sweep_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    outputs.octants = words.data();
    check(dfield_volume_sweep(context.get(), &samples, &desc, &outputs, nullptr));
    return words;
}
std::uint8_t swept_octant(const std::vector<std::uint8_t>& words, std::size_t sample, std::size_t octant) {
    return words[4 * (sample + octant / 4 * (words.size() / 8)) + octant % 4];
}

// Places beside the object with a normal each, and what they see of the sky by ray casting.
struct Trials {
    std::vector<std::size_t> samples;
    std::vector<glm::vec3> normals;
    std::vector<float> visibility;

    Trials(const EmbreeScene& scene, const SampleGrid& grid, const Matter& matter,
           const VolumeBakeOptions& options) {
        const std::vector<glm::vec3> around = fibonacci_sphere(kTrials);
        std::vector<glm::vec3> positions;
        // Even over the grid by the golden ratio; not in a layer that might become matter.
        const float clear = (kSolidLayers.back() + 1) * grid.spacing;
        for (std::size_t k = 0; k < 16 * kTrials && samples.size() < kTrials; ++k) {
            const double place = std::fmod(0.5 + 0.6180339887498949 * static_cast<double>(k), 1.0);
            const auto sample = static_cast<std::size_t>(place * static_cast<double>(grid.size()));
            if (matter.inside[sample] || matter.distance[sample] < clear) continue;
            samples.push_back(sample);
            // Towards the object: who looks away sees it at the rim of the sky, if at all.
            glm::vec3 normal = around[(samples.size() * 197) % kTrials];
            if (glm::dot(normal, grid.point(sample)) > 0) normal = -normal;
            normals.push_back(normal);
            positions.push_back(grid.point(sample) - kLookUpAhead * grid.spacing * normal);
        }
        const std::vector<glm::vec3> directions = cosine_directions(kTrialRays);
        RayVisibilityOptions rays;
        rays.directions = directions;
        rays.threads = options.threads;
        rays.cancel = options.cancel;
        visibility = ray_visibility(scene, positions, normals, rays);
    }

    // Sum of squares of what equation 4 makes of the octants less what rays see.
    double error(const std::vector<std::uint8_t>& words) const {
        double squares = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            std::array<float, kVolumeOctants> terms;
            dfield_octant_geometry(&normals[k].x, 0, terms.data());
            double open = 0;
            for (std::size_t octant = 0; octant < kVolumeOctants; ++octant)
                open += terms[octant] * swept_octant(words, samples[k], octant) / (255 * glm::pi<double>());
            squares += (open - visibility[k]) * (open - visibility[k]);
        }
        return squares;
    }
};

// The layers with which octants come closest to ray casting: of solids first, then of sheets.
Layers best_layers(const EmbreeScene& scene, const SampleGrid& grid, const Matter& matter,
                   const VolumeBakeOptions& options) {
    const Trials trials(scene, grid, matter, options);
    Layers best = kFirstLayers;
    const auto choose = [&](float Layers::*layer, const auto& candidates) {
        std::array<double, kSolidLayers.size()> errors;
        parallel_ranges(options.threads, candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                check_cancel(options);
                Layers tried = best;
                tried.*layer = candidates[k];
                errors[k] = trials.error(swept_octants(grid, depths(grid, matter, tried)));
            }
        });
        best.*layer = candidates[static_cast<std::size_t>(std::min_element(errors.begin(), errors.end()) -
                                                          errors.begin())];
    };
    static_assert(kSolidLayers.size() == kSheetLayers.size());
    if (matter.solid) choose(&Layers::solid, kSolidLayers);
    if (matter.open) choose(&Layers::sheet, kSheetLayers);
    return best;
}

// The swept octants. Samples in the matter next to others get the mean of those around them: between samples,
// what is beside the object is not to be darkened by what is in it.
void store_octants(const SampleGrid& grid, const std::vector<float>& depth,
                   const std::vector<std::uint8_t>& words, OcclusionVolume& volume) {
    volume.octants.resize(2 * grid.size());
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < grid.dims[2]; ++z)
        for (std::uint32_t y = 0; y < grid.dims[1]; ++y)
            for (std::uint32_t x = 0; x < grid.dims[0]; ++x, ++i) {
                std::array<std::uint32_t, kVolumeOctants> sum{};
                std::uint32_t count = 0;
                const auto add = [&](std::size_t sample) {
                    ++count;
                    for (std::size_t octant = 0; octant < kVolumeOctants; ++octant)
                        sum[octant] += swept_octant(words, sample, octant);
                };
                if (depth[i] >= 0)
                    for (std::uint32_t c = z - (z > 0); c <= std::min(z + 1, grid.dims[2] - 1); ++c)
                        for (std::uint32_t b = y - (y > 0); b <= std::min(y + 1, grid.dims[1] - 1); ++b)
                            for (std::uint32_t a = x - (x > 0); a <= std::min(x + 1, grid.dims[0] - 1); ++a) {
                                const std::size_t beside =
                                    a + grid.dims[0] * (b + std::size_t{grid.dims[1]} * c);
                                if (depth[beside] < 0) add(beside);
                            }
                if (count == 0) add(i);
                for (std::size_t octant = 0; octant < kVolumeOctants; ++octant)
                    volume.set_octant(i, octant,
                                      static_cast<std::uint8_t>((sum[octant] + count / 2) / count));
            }
}

bool blocked(const EmbreeScene& scene, const glm::vec3& origin, const glm::vec3& direction) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray{origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, 4, ~0u, 0, 0};
    rtcOccluded1(scene.get(), &context, &ray);
    return ray.tfar < 0;
}

// The ball that has, seen along a direction, the object's silhouette for its area and its middle from
// infinity, and the object's solid angle from kFarNear.
FarBall far_ball(const EmbreeScene& scene, const glm::vec3& direction, const std::vector<glm::vec3>& cone) {
    const Frame frame = frame_of_normal(direction);
    glm::dvec2 middle(0);
    std::uint32_t hits = 0;
    for (std::uint32_t t = 0; t < kSilhouette; ++t)
        for (std::uint32_t s = 0; s < kSilhouette; ++s) {
            const glm::vec2 place = (glm::vec2(s, t) + 0.5f) * (2.0f / kSilhouette) - 1.0f;
            if (glm::dot(place, place) > 1 ||
                !blocked(scene, frame.to_world({place.x, place.y, 2}), -direction))
                continue;
            ++hits;
            middle += glm::dvec2(place);
        }
    if (hits == 0) return {0, 128, 128, 128};
    middle /= hits;
    const double radius = 2.0 / kSilhouette * std::sqrt(hits / glm::pi<double>());
    std::uint32_t seen = 0;
    for (const glm::vec3& ray : cone)
        seen += blocked(scene, kFarNear * direction, -frame.to_world(ray)) ? 1 : 0;
    const double cone_cosine = std::sqrt(1 - 1.0 / (kFarNear * kFarNear));
    const double share = static_cast<double>(seen) / static_cast<double>(cone.size()) * (1 - cone_cosine);
    double along = 0;
    if (seen > 0) {
        const double away = radius / std::sqrt(share * (2 - share));  // sin^2 = 1 - (1 - share)^2
        along = kFarNear - std::sqrt(std::max(0.0, away * away - glm::dot(middle, middle)));
    }
    const glm::vec3 place = frame.to_world({middle.x, middle.y, glm::clamp(along, -1.0, 1.0)});
    const auto byte = [](float value) {
        return static_cast<std::uint8_t>(std::lround(127 * glm::clamp(value, -1.0f, 1.0f)) + 128);
    };
    return {static_cast<std::uint8_t>(std::min(255l, std::lround(255 * radius))), byte(place.x),
            byte(place.y), byte(place.z)};
}

// Directions around +z, spread evenly over the cone in which the unit sphere is seen from kFarNear.
std::vector<glm::vec3> cone_directions() {
    const double cosine = std::sqrt(1 - 1.0 / (kFarNear * kFarNear));
    std::vector<glm::vec3> directions;
    for (std::uint32_t i = 0; i < kConeRays; ++i) {
        const double z = 1 - (1 - cosine) * (i + 0.5) / kConeRays, r = std::sqrt(1 - z * z);
        const double phi = 2 * glm::pi<double>() * std::fmod(i * 0.6180339887498949, 1.0);
        directions.emplace_back(r * std::cos(phi), r * std::sin(phi), z);
    }
    return directions;
}

}  // namespace

std::string volume_parameters_error(const VolumeParameters& parameters) {
    if (parameters.size >= kSmallestVolume && parameters.size <= kMaxVolumeSize) return {};
    return "an occlusion volume of " + std::to_string(parameters.size) + " samples a side is outside " +
           std::to_string(kSmallestVolume) + ".." + std::to_string(kMaxVolumeSize);
}

std::uint64_t volume_parameters_bytes(const VolumeParameters& parameters) {
    const std::uint64_t size = parameters.size;
    return 8 * size * size * size + 4 * kFarSize * kFarSize;
}

OcclusionVolume bake_volume(const TriangleMesh& mesh, const BoundingSphere& sphere,
                            const VolumeBakeOptions& options, VolumeBakeReport* report) {
    if (const std::string error = volume_parameters_error(options.parameters); !error.empty())
        throw InputError(error);
    const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    auto start = std::chrono::steady_clock::now();
    const TriangleMesh unit = unit_mesh(mesh, sphere);
    EmbreeScene scene(EmbreeUse::kBake);
    rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                             RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    scene.add_mesh(unit);
    scene.commit(options.threads);
    VolumeBakeReport result;
    result.build_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    const SampleGrid grid = grid_around(triangle_bounds(unit), options.parameters.size);
    OcclusionVolume volume;
    volume.dims = grid.dims;
    volume.origin = sphere.radius * grid.origin + sphere.centre;
    volume.spacing = sphere.radius * grid.spacing;
    const Bounds box = triangle_bounds(mesh);
    const glm::vec3 extent = box.size();
    // From the box on: where the grid ends, the ball alone counts.
    volume.blend = std::max(volume.spacing, kMargin * std::max({extent.x, extent.y, extent.z}));
    volume.far_size = kFarSize;
    const Matter matter = matter_around(scene, unit, grid, options);
    const std::vector<float> depth = depths(grid, matter, best_layers(scene, grid, matter, options));
    store_octants(grid, depth, swept_octants(grid, depth), volume);

    const std::vector<glm::vec3> cone = cone_directions();
    volume.far.resize(std::size_t{kFarSize} * kFarSize);
    parallel_ranges(options.threads, volume.far.size(), 1, [&](std::size_t begin, std::size_t end) {
        check_cancel(options);
        for (std::size_t i = begin; i < end; ++i) {
            const auto node = static_cast<std::uint32_t>(i);
            volume.far[i] = pack_far_ball(
                far_ball(scene, far_direction(kFarSize, node % kFarSize, node / kFarSize), cone));
        }
    });
    result.trace_seconds = seconds_since(start);
    result.rays = grid.size() + kTrials * kTrialRays +
                  std::uint64_t{volume.far.size()} * (kSilhouette * kSilhouette + kConeRays);
    for (std::size_t axis = 0; axis < 3; ++axis) result.rays += grid.size() / grid.dims[axis];
    if (report) *report = result;
    return volume;
}

}  // namespace dfield
