#include "baker/cli/runtime_scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/parallel.hpp"

namespace dfield::cli {
namespace {

Context make_context(Threads& threads, dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    threads.install(desc);
    desc.simd = simd;
    return Context(&desc);
}

}  // namespace

ThreadedContext::ThreadedContext(int threads, dfield_simd simd)
    : threads_(std::make_unique<Threads>(static_cast<unsigned>(thread_count(threads)))),
      context_(make_context(*threads_, simd)) {}

const char* name_of(dfield_kind kind) {
    switch (kind) {
        case DFIELD_KIND_MAPS:
            return "maps";
        case DFIELD_KIND_LINES:
            return "lines";
        case DFIELD_KIND_DIRECTIONS:
            return "directions";
        case DFIELD_KIND_VOLUME:
            return "volume";
        default:
            return "auto";
    }
}

dfield_receivers Receivers::view(std::span<const dfield_instance> owners) const {
    dfield_receivers view{};
    view.count = positions.size();
    view.positions = positions.empty() ? nullptr : &positions.front().x;
    view.normals = normals.empty() ? nullptr : &normals.front().x;
    view.owners = owners.empty() ? nullptr : owners.data();
    return view;
}

bool casts(const TriangleMesh& mesh, const glm::mat4& transform) {
    const glm::dmat3 linear(transform);
    const double box = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    return !mesh.triangles.empty() && std::fabs(glm::determinant(linear)) > 1e-9 * box;
}

void note_flat_nodes(ImportedScene& scene) {
    for (const SceneInstance& instance : scene.instances) {
        const TriangleMesh& mesh = scene.meshes[instance.mesh].mesh;
        if (!mesh.triangles.empty() && !casts(mesh, instance.transform))
            scene.report.warnings.push_back("node '" + instance.name +
                                            "' is scaled by zero along an axis: it occludes nothing");
    }
}

Receivers placed_vertices(const TriangleMesh& mesh, const glm::mat4& transform) {
    Receivers receivers;
    receivers.positions.reserve(mesh.positions.size());
    receivers.normals.reserve(mesh.positions.size());
    // Cofactors rather than the inverse transpose: the same direction up to the determinant's sign, finite
    // for flat transforms too.
    const glm::mat3 m(transform);
    const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const float sign = glm::dot(m[0], cofactors[0]) < 0 ? -1.0f : 1.0f;
    for (const glm::vec3& position : mesh.positions)
        receivers.positions.emplace_back(transform * glm::vec4(position, 1));
    for (const glm::vec3& normal : mesh.normals) {
        const glm::vec3 moved = sign * (cofactors * normal);
        const float length = glm::length(moved);
        receivers.normals.push_back(length > 0 ? moved / length : normal);
    }
    return receivers;
}

}  // namespace dfield::cli
