#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "baker/mesh.hpp"
#include "tests/import/test_files.hpp"

using dfield::TriangleMesh;

namespace {

// Eight vertices, twelve triangles, wound outwards; the diagonals make area weights wrong at the corners.
TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

TriangleMesh sphere(int rings, int sectors) {
    TriangleMesh mesh;
    mesh.positions.emplace_back(0, 0, 1);
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < sectors; ++s) {
            const double theta = M_PI * r / rings, phi = 2 * M_PI * s / sectors;
            mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                        std::cos(theta));
        }
    mesh.positions.emplace_back(0, 0, -1);
    const auto last = static_cast<unsigned>(mesh.positions.size() - 1), n = static_cast<unsigned>(sectors);
    const auto at = [&](int r, int s) {
        return 1 + static_cast<unsigned>(r - 1) * n + static_cast<unsigned>(s) % n;
    };
    for (int s = 0; s < sectors; ++s) {
        mesh.triangles.emplace_back(0, at(1, s), at(1, s + 1));
        mesh.triangles.emplace_back(last, at(rings - 1, s + 1), at(rings - 1, s));
        for (int r = 1; r + 1 < rings; ++r) {
            mesh.triangles.emplace_back(at(r, s), at(r + 1, s), at(r + 1, s + 1));
            mesh.triangles.emplace_back(at(r, s), at(r + 1, s + 1), at(r, s + 1));
        }
    }
    return mesh;
}

void check_unit(const TriangleMesh& mesh) {
    REQUIRE(mesh.normals.size() == mesh.positions.size());
    for (const glm::vec3& n : mesh.normals) REQUIRE(glm::length(n) == Approx(1).epsilon(1e-5));
}

}  // namespace

TEST_CASE("a cube's smooth normals are its diagonals: weights are angles, not areas") {
    TriangleMesh mesh = cube();
    dfield::compute_normals(mesh);
    check_unit(mesh);
    CHECK(mesh.positions.size() == 8);
    for (std::size_t i = 0; i < 8; ++i)
        CHECK(glm::distance(mesh.normals[i], glm::normalize(mesh.positions[i])) < 1e-6f);
}

TEST_CASE("a crease angle below 90 degrees splits a cube into its sides") {
    for (const float crease : {0.0f, 30.0f, 89.0f}) {
        TriangleMesh mesh = cube();
        const double area = dfield::test::area(mesh);
        dfield::compute_normals(mesh, crease);
        check_unit(mesh);
        CHECK(mesh.positions.size() == 24);
        CHECK(mesh.triangles.size() == 12);
        CHECK(dfield::test::area(mesh) == Approx(area));
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::vec3 face = glm::normalize(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                                             mesh.positions[t.z] - mesh.positions[t.x]));
            for (int k = 0; k < 3; ++k) CHECK(glm::distance(mesh.normals[t[k]], face) < 1e-6f);
        }
    }
    TriangleMesh mesh = cube();
    dfield::compute_normals(mesh, 91);
    CHECK(mesh.positions.size() == 8);
}

TEST_CASE("a sphere's normals are its positions") {
    TriangleMesh mesh = sphere(48, 96);
    dfield::compute_normals(mesh);
    check_unit(mesh);
    float worst = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        worst = std::max(worst, glm::distance(mesh.normals[i], mesh.positions[i]));
    CHECK(worst < 2e-3f);
    TriangleMesh creased = sphere(48, 96);
    dfield::compute_normals(creased, 30);
    CHECK(creased.positions.size() == mesh.positions.size());
    CHECK(creased.normals == mesh.normals);
}

TEST_CASE("three sheets at one edge: nothing is lost or duplicated") {
    // Non-manifold: OpenMesh would give the third triangle vertices of its own.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    TriangleMesh smooth = mesh, creased = mesh;
    dfield::compute_normals(smooth);
    check_unit(smooth);
    CHECK(smooth.positions.size() == 5);
    CHECK(smooth.triangles == mesh.triangles);
    dfield::compute_normals(creased, 60);
    check_unit(creased);
    CHECK(creased.positions.size() == 9);
    CHECK(dfield::test::area(creased) == Approx(dfield::test::area(mesh)));
    for (std::size_t t = 0; t < 3; ++t)
        for (int k = 0; k < 3; ++k)
            CHECK(creased.positions[creased.triangles[t][k]] == mesh.positions[mesh.triangles[t][k]]);
}

TEST_CASE("duplicates, opposite sides, unused vertices and slivers all get unit normals") {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 2}, {0, 2, 1}, {0, 2, 1}, {0, 1, 4}};
    dfield::compute_normals(mesh);
    check_unit(mesh);
    CHECK(mesh.normals[3] == glm::vec3(0, 0, 1));
    CHECK(std::abs(mesh.normals[0].z) == Approx(1));
    dfield::compute_normals(mesh, 45);
    check_unit(mesh);
    CHECK(mesh.triangles.size() == 5);
}

TEST_CASE("meshes have a box and an identity") {
    TriangleMesh mesh = cube();
    mesh.positions.emplace_back(100, 100, 100);  // used by no triangle
    const dfield::Bounds bounds = dfield::triangle_bounds(mesh);
    CHECK(bounds.min == glm::vec3(-1));
    CHECK(bounds.max == glm::vec3(1));
    const std::string hash = dfield::mesh_hash(mesh);
    CHECK(hash.size() == 32);
    CHECK(hash.find_first_not_of("0123456789abcdef") == std::string::npos);
    CHECK(dfield::mesh_hash(mesh) == hash);
    TriangleMesh moved = mesh, turned = mesh;
    moved.positions[0].x += 1e-6f;
    std::swap(turned.triangles[0].x, turned.triangles[0].y);
    CHECK(dfield::mesh_hash(moved) != hash);
    CHECK(dfield::mesh_hash(turned) != hash);
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0, 0, 1));
    CHECK(dfield::mesh_hash(mesh) == hash);  // what is traced has no normals
}
