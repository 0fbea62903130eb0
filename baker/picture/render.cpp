#include "baker/picture/render.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include "baker/embree_scene.hpp"
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

}  // namespace

Image render(std::span<const RenderObject> objects, const Camera& camera, const RenderOptions& options) {
    if (camera.up == glm::vec3(0)) throw std::invalid_argument("render: a camera without direction");
    const World world(objects, glm::normalize(camera.up));
    return render_rays(camera, options, [&](const glm::vec3& origin, const glm::vec3& direction) {
        return world.trace(origin, direction);
    });
}

}  // namespace dfield
