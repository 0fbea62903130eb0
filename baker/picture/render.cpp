#include "baker/picture/render.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include "baker/embree_scene.hpp"
#include "baker/parallel.hpp"

namespace dfield {
namespace {

// With several, the order of triangles in the tree, and with it which of two equally near triangles is hit,
// would depend on timing.
constexpr int kBuildThreads = 1;

// The objects as instances of their meshes in one Embree scene, and what a ray sees in it.
class World {
  public:
    World(std::span<const RenderObject> objects, const glm::vec3& zenith)
        : objects_(objects), zenith_(zenith) {
        for (const RenderObject& object : objects) {
            to_object_.push_back(glm::inverse(glm::mat3(object.transform)));
            if (!object.mesh || !std::isfinite(glm::determinant(to_object_.back())))
                throw std::invalid_argument("render: an object without mesh or with a singular transform");
            if (!object.visibility.empty() && object.visibility.size() != object.mesh->positions.size())
                throw std::invalid_argument("render: one visibility for each vertex, or none at all");
            // An empty mesh has an empty scene, so that instance ids stay the objects' indices.
            auto& mesh = meshes_[object.mesh];
            if (!mesh) {
                mesh = std::make_unique<EmbreeScene>(EmbreeUse::kBake);
                if (!object.mesh->triangles.empty()) mesh->add_mesh(*object.mesh);
                mesh->commit(kBuildThreads);
            }
            scene_.add_instance(*mesh, object.transform);
        }
        scene_.commit(kBuildThreads);
    }

    // Colour of the nearest surface along the ray, or nothing.
    std::optional<glm::vec3> trace(const glm::vec3& origin, const glm::vec3& direction) const {
        RTCRayHit query{};
        query.ray.org_x = origin.x, query.ray.org_y = origin.y, query.ray.org_z = origin.z;
        query.ray.dir_x = direction.x, query.ray.dir_y = direction.y, query.ray.dir_z = direction.z;
        query.ray.mask = ~0u;
        while (true) {
            query.ray.tfar = std::numeric_limits<float>::infinity();
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            rtcIntersect1(scene_.get(), &context, &query);
            if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
            if (const auto color = shade(query.hit, direction)) return color;
            // Behind a culled surface the ray goes on.
            query.ray.tnear = std::nextafter(query.ray.tfar, std::numeric_limits<float>::infinity());
        }
    }

  private:
    // Nothing for a back face that is not drawn.
    std::optional<glm::vec3> shade(const RTCHit& hit, const glm::vec3& direction) const {
        const RenderObject& object = objects_[hit.instID[0]];
        const TriangleMesh& mesh = *object.mesh;
        const glm::uvec3 triangle = mesh.triangles[hit.primID];
        const auto interpolate = [&](const auto& values) {
            return (1.0f - hit.u - hit.v) * values[triangle.x] + hit.u * values[triangle.y] +
                   hit.v * values[triangle.z];
        };
        const glm::vec3& corner = mesh.positions[triangle.x];
        glm::vec3 facet =
            glm::cross(mesh.positions[triangle.y] - corner, mesh.positions[triangle.z] - corner);
        if (glm::dot(facet, to_object_[hit.instID[0]] * direction) > 0) {
            if (object.cull_back) return std::nullopt;
            facet = -facet;
        }
        float grey =
            object.visibility.empty() ? 1.0f : std::clamp(interpolate(object.visibility), 0.0f, 1.0f);
        if (object.shade) {
            glm::vec3 normal = mesh.normals.empty() ? facet : interpolate(mesh.normals);
            if (!(glm::dot(normal, normal) > 0)) normal = facet;
            if (glm::dot(normal, facet) < 0) normal = -normal;
            normal = glm::normalize(glm::transpose(to_object_[hit.instID[0]]) * normal);
            grey *= 0.6f + 0.4f * glm::dot(normal, zenith_);
        }
        return grey * object.albedo;
    }

    std::span<const RenderObject> objects_;
    glm::vec3 zenith_;
    std::vector<glm::mat3> to_object_;
    std::unordered_map<const TriangleMesh*, std::unique_ptr<EmbreeScene>> meshes_;
    EmbreeScene scene_{EmbreeUse::kBake};  // its instruction set is fixed, so pictures do not vary by machine
};

struct Basis {
    glm::vec3 right, up, back;
};

// Right-handed, looking along -back. A view straight along `up` still gets a frame.
Basis view_basis(const glm::vec3& back, const glm::vec3& up) {
    Basis basis;
    basis.back = glm::normalize(back);
    glm::vec3 right = glm::cross(up, basis.back);
    if (glm::dot(right, right) < 1e-12f * glm::dot(up, up))
        right =
            glm::cross(std::abs(basis.back.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0), basis.back);
    basis.right = glm::normalize(right);
    basis.up = glm::cross(basis.back, basis.right);
    return basis;
}

}  // namespace

Camera frame_bounds(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                    float fov_degrees, float aspect) {
    constexpr float kMargin = 0.96f;  // of the half picture, so 2% stay free on each side
    const Basis basis = view_basis(direction_to_eye, up);
    const float tangent_y = kMargin * std::tan(0.5f * glm::radians(fov_degrees));
    const float tangent_x = tangent_y * aspect;
    // A corner at (x, z) is in view of an eye at (ex, ez) when +-(x - ex) <= (ez - z) tangent: the extremes
    // of z tangent +- x give the nearest eye for each axis, centred between them.
    constexpr float kLowest = std::numeric_limits<float>::lowest();
    float right = kLowest, left = kLowest, top = kLowest, bottom = kLowest;
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner(i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                               i & 4 ? bounds.max.z : bounds.min.z);
        const glm::vec3 offset = corner - bounds.centre();
        const float x = glm::dot(offset, basis.right), y = glm::dot(offset, basis.up),
                    z = glm::dot(offset, basis.back);
        right = std::max(right, z * tangent_x + x), left = std::max(left, z * tangent_x - x);
        top = std::max(top, z * tangent_y + y), bottom = std::max(bottom, z * tangent_y - y);
    }
    const float distance = std::max(0.5f * (right + left) / tangent_x, 0.5f * (top + bottom) / tangent_y);
    Camera camera;
    camera.target = bounds.centre() + 0.5f * (right - left) * basis.right + 0.5f * (top - bottom) * basis.up;
    camera.eye = camera.target + distance * basis.back;
    camera.up = up;
    camera.vertical_fov_degrees = fov_degrees;
    return camera;
}

Image render(std::span<const RenderObject> objects, const Camera& camera, const RenderOptions& options) {
    if (camera.eye == camera.target || camera.up == glm::vec3(0) || options.samples == 0)
        throw std::invalid_argument("render: a camera without direction, or no samples");
    const World world(objects, glm::normalize(camera.up));
    const Basis basis = view_basis(camera.eye - camera.target, camera.up);
    const float half_height = std::tan(0.5f * glm::radians(camera.vertical_fov_degrees));
    const float pixel = 2 * half_height / static_cast<float>(options.height);
    const auto n = options.samples;
    const auto n_squared = static_cast<float>(n * n);

    // Sample (i, j) of a pixel lies in cell (i, j) of an n x n grid and alone in its column and row of an n^2
    // x n^2 grid, so an upright edge gets n^2 + 1 greys rather than n + 1.
    const auto sample_colour = [&](std::uint32_t x, std::uint32_t y, std::uint32_t i, std::uint32_t j) {
        const float px = static_cast<float>(x) + (static_cast<float>(i * n + j) + 0.5f) / n_squared;
        const float py = static_cast<float>(y) + (static_cast<float>(j * n + i) + 0.5f) / n_squared;
        const glm::vec3 direction = (px - 0.5f * static_cast<float>(options.width)) * pixel * basis.right +
                                    (half_height - py * pixel) * basis.up - basis.back;
        return world.trace(camera.eye, direction).value_or(options.background);
    };

    Image image(options.width, options.height);
    parallel_ranges(options.threads, options.height, 4, [&](std::size_t begin, std::size_t end) {
        for (auto y = static_cast<std::uint32_t>(begin); y < end; ++y)
            for (std::uint32_t x = 0; x < options.width; ++x) {
                glm::vec3 sum(0);
                for (std::uint32_t j = 0; j < n; ++j)
                    for (std::uint32_t i = 0; i < n; ++i) sum += sample_colour(x, y, i, j);
                for (int c = 0; c < 3; ++c)
                    image.at(x, y)[c] = static_cast<std::uint8_t>(
                        std::lround(255.0f * std::clamp(sum[c] / n_squared, 0.0f, 1.0f)));
            }
    });
    return image;
}

}  // namespace dfield
