#include "baker/import/polygon_soup.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "baker/error.hpp"
#include "baker/import/triangulate.hpp"

namespace dfield {
namespace {

constexpr std::size_t kMaxCorners = 65536;  // ear clipping is quadratic at worst

void add_triangle(TriangleMesh& mesh, ImportReport& report, const glm::uvec3& triangle) {
    const glm::dvec3 a(mesh.positions[triangle.x]), b(mesh.positions[triangle.y]),
        c(mesh.positions[triangle.z]);
    // In double the differences of floats are exact enough that only true collinearity gives 0.
    if (glm::cross(b - a, c - a) == glm::dvec3(0)) {
        ++report.degenerate;
        return;
    }
    mesh.triangles.push_back(triangle);
    ++report.triangles;
}

}  // namespace

bool usable_position(const glm::vec3& position) {
    constexpr float kLimit = 3.3e38f;  // the readers' mark for "nan" in text lies above (text_scan.hpp)
    return std::abs(position.x) < kLimit && std::abs(position.y) < kLimit && std::abs(position.z) < kLimit;
}

void add_face(TriangleMesh& mesh, ImportReport& report, std::span<const std::uint32_t> corners,
              const std::string& file) {
    ++report.faces;
    if (corners.size() > kMaxCorners)
        throw InputError(file + ": a face has " + std::to_string(corners.size()) + " corners; the most is " +
                         std::to_string(kMaxCorners) + ": triangulate it in the program that wrote it");
    if (std::any_of(corners.begin(), corners.end(), [&](auto i) { return i >= mesh.positions.size(); })) {
        ++report.index_out_of_range;
        return;
    }
    if (corners.size() < 3) {
        ++report.degenerate;
        return;
    }
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](auto i) { return usable_position(mesh.positions[i]); })) {
        report.not_finite += corners.size() - 2;
        return;
    }
    if (corners.size() == 3) return add_triangle(mesh, report, {corners[0], corners[1], corners[2]});

    std::vector<glm::vec3> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners) points.push_back(mesh.positions[corner]);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangulate(points, triangles);
    for (const auto& t : triangles) add_triangle(mesh, report, {corners[t[0]], corners[t[1]], corners[t[2]]});
}

void finish_mesh(TriangleMesh& mesh, float crease_degrees) {
    for (glm::vec3& position : mesh.positions)
        if (!usable_position(position)) position = glm::vec3(0);
    if (mesh.normals.empty()) return compute_normals(mesh, crease_degrees);

    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const glm::dvec3 normal(mesh.normals[i]);
        const double length = glm::length(normal);
        if (usable_position(mesh.normals[i]) && length > 0)
            mesh.normals[i] = glm::vec3(normal / length);
        else
            missing.push_back(i);
    }
    if (missing.empty()) return;
    TriangleMesh computed{mesh.positions, {}, mesh.triangles};
    compute_normals(computed);
    for (const std::size_t i : missing) mesh.normals[i] = computed.normals[i];
}

}  // namespace dfield
