// The formats without nodes, each in its variants, on small files whose contents are known.
#include <catch2/catch.hpp>
#include <limits>

#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/import/test_files.hpp"

using Catch::Contains;
using dfield::import_scene;
using dfield::ImportedScene;
using dfield::test::area;
using dfield::test::bytes_of;
using dfield::test::TestFolder;

namespace {

ImportedScene import_text(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    return import_scene(folder.write(name, bytes));
}

const std::vector<glm::vec3> kSquare = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};

void check_square(const ImportedScene& scene) {
    REQUIRE(scene.meshes.size() == 1);
    REQUIRE(scene.instances.size() == 1);
    const dfield::TriangleMesh& mesh = scene.meshes[0].mesh;
    CHECK(mesh.positions == kSquare);
    CHECK(mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}});
    for (const glm::vec3& n : mesh.normals) CHECK(n == glm::vec3(0, 0, 1));
    CHECK(mesh.normals.size() == 4);
    CHECK(scene.report.faces == 1);
    CHECK(scene.report.triangles == 2);
    CHECK(scene.report.degenerate + scene.report.not_finite + scene.report.index_out_of_range == 0);
    CHECK(scene.report.warnings.empty());
    CHECK(scene.instances[0].transform == glm::mat4(1));
}

std::string ply_header(const std::string& format, const std::string& face_properties) {
    return "ply\nformat " + format +
           " 1.0\ncomment nan inf\nelement vertex 4\nproperty uchar red\nproperty float x\n" +
           "property double y\nproperty list uchar short tags\nproperty float z\n" + "element face 1\n" +
           face_properties + "end_header\n";
}

std::string ply_body(bool big) {
    std::string body;
    for (const glm::vec3& p : kSquare)
        body += bytes_of<std::uint8_t>({200}) + bytes_of<float>({p.x}, big) + bytes_of<double>({p.y}, big) +
                bytes_of<std::uint8_t>({2}) + bytes_of<std::int16_t>({7, 8}, big) +
                bytes_of<float>({p.z}, big);
    body += bytes_of<std::uint8_t>({3}) + bytes_of<float>({.1f, .2f, .3f}, big);  // a list before the outline
    body += bytes_of<std::uint16_t>({4}, big) + bytes_of<std::int32_t>({0, 1, 2, 3}, big);
    return body;
}

std::string stl_facet(const std::vector<glm::vec3>& corners) {
    std::string facet(12, '\0');
    for (const glm::vec3& p : corners) facet += bytes_of<float>({p.x, p.y, p.z});
    return facet + std::string(2, '\0');
}

std::string binary_stl(const std::string& title, const std::vector<std::string>& facets) {
    std::string file = title + std::string(80 - title.size(), ' ');
    file += bytes_of<std::uint32_t>({static_cast<std::uint32_t>(facets.size())});
    for (const std::string& facet : facets) file += facet;
    return file;
}

}  // namespace

TEST_CASE("OBJ: quads, negative indices, continued lines, colours, unknown lines") {
    check_square(import_text("a.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n"));
    check_square(import_text("a.OBJ",
                             "# c\r\nmtllib /etc/passwd\r\no thing\r\nv +0 0 0 1 .5 .5\r\nv 2e0 0 0\r\n"
                             "v 2 2.0 0 # corner\r\nv 0 2 -0\r\nvt 0 0\r\nusemtl x\r\ns off\r\n"
                             "f -4/1 -3/1 \\\r\n -2/1 -1/1\r\nweird line\r\n"));
}

TEST_CASE("OBJ: normals of the file are kept, vertices whose corners disagree are split") {
    const ImportedScene same =
        import_text("a.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvn 0 0 2\nf 1//1 2//1 3//1 4//1\n");
    check_square(same);
    const ImportedScene kept =
        import_text("a.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nvn 1 0 0\nf 1//1 2//-1 3//1\n");
    for (const glm::vec3& n : kept.meshes[0].mesh.normals) CHECK(n == glm::vec3(1, 0, 0));
    // A roof: the ridge 2-3 has one normal per side.
    const ImportedScene roof = import_text("roof.obj",
                                           "v 0 0 0\nv 1 0 1\nv 1 1 1\nv 2 0 0\nvn -1 0 1\nvn 1 0 1\n"
                                           "f 1//1 2//1 3//1\nf 3//2 2//2 4//2\n");
    const dfield::TriangleMesh& mesh = roof.meshes[0].mesh;
    CHECK(mesh.positions.size() == 6);
    REQUIRE(mesh.triangles.size() == 2);
    for (int k = 0; k < 3; ++k) {
        CHECK(mesh.normals[mesh.triangles[0][k]].x == Approx(-std::sqrt(0.5)));
        CHECK(mesh.normals[mesh.triangles[1][k]].x == Approx(std::sqrt(0.5)));
    }
    // Where a corner has no (usable) normal, it is computed.
    const ImportedScene mixed =
        import_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn nan 0 0\nf 1//1 2 3//2\n");
    CHECK(mixed.meshes[0].mesh.normals == std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}});
}

TEST_CASE("OBJ: concave polygons and polygons with a hole keep their area") {
    const ImportedScene notch =
        import_text("a.obj", "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 2 0 1\nv 0 0 4\nf 1 2 3 4 5\n");
    CHECK(notch.report.triangles == 3);
    CHECK(area(notch.meshes[0].mesh) == Approx(10));
    // The hole is joined by a seam: vertices 1 and 5 stand twice in the face.
    const ImportedScene hole =
        import_text("a.obj",
                    "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                    "f 1 2 3 4 1 5 6 7 8 5\n");
    CHECK(hole.report.faces == 1);
    CHECK(hole.report.triangles + hole.report.degenerate == 8);
    CHECK(area(hole.meshes[0].mesh) == Approx(12));
    CHECK(hole.meshes[0].mesh.positions.size() == 8);
}

TEST_CASE("OBJ: duplicates and non-manifold faces stay, what cannot be hit is counted") {
    const std::string vertices =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 2 0 0\nv nan 0 0\nv 0 inf 0\nv 1e99 0 0\n";
    const ImportedScene scene =
        import_text("a.obj", vertices +
                                 "f 1 2 3\nf 1 2 3\nf 3 2 1\nf 1 2 4\nf 2 1 5 4\n"  // usable
                                 "f 1 1 2\nf 1 2 5\nf 1 2\n"                        // no area
                                 "f 1 2 6\nf 1 7 2 3\nf 8 1 2\n"                    // not finite
                                 "f 1 2 9\nf 0 1 2\nf 1 2 -99\nf 1 2 99999999999\nl 1 2\np 1\n");
    const dfield::ImportReport& report = scene.report;
    CHECK(report.faces == 15);
    CHECK(report.triangles + report.degenerate == 4 + 2 + 3);
    CHECK(report.degenerate >= 3);
    CHECK(report.not_finite == 4);  // the quad counts as two
    CHECK(report.index_out_of_range == 4);
    CHECK(report.skipped_primitives == 2);
    const dfield::TriangleMesh& mesh = scene.meshes[0].mesh;
    CHECK(mesh.positions.size() == 8);
    CHECK(mesh.positions[4] == glm::vec3(2, 0, 0));  // a bad vertex does not shift the others
    CHECK(report.triangles == mesh.triangles.size());
    CHECK(mesh.triangles[0] == mesh.triangles[1]);
    for (const glm::vec3& p : mesh.positions) CHECK(std::isfinite(p.x + p.y + p.z));
    for (const glm::vec3& n : mesh.normals) CHECK(glm::length(n) == Approx(1));
}

TEST_CASE("PLY: text and both byte orders, foreign properties and elements, normals") {
    const std::string outline = "property list uchar float uv\nproperty list ushort int vertex_index\n";
    check_square(import_text("a.ply", ply_header("binary_little_endian", outline) + ply_body(false)));
    check_square(import_text("a.ply", ply_header("binary_big_endian", outline) + ply_body(true)));
    check_square(
        import_text("a.ply", ply_header("ascii", outline) +
                                 "9 0 0 0 0\n9 2 0 1 5 0\n9 2 2 2 5 6 0\n9 0 2 0 0\n1 0.5 4 0 1 2 3\n"));
    check_square(
        import_text("a.ply",
                    "ply\r\nformat ascii 1.0\r\nelement edge 2\r\nproperty list uchar int e\r\n"
                    "element vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
                    "element face 1\r\nproperty list uchar int vertex_indices\r\nelement end 0\r\n"
                    "end_header\r\n2 0 1\r\n0\r\n0 0 0\r\n2 0 0\r\n2 2 0\r\n0 2 0\r\n4 0 1 2 3\r\n"));
    const ImportedScene scene = import_text(
        "n.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 3 0 0\n1 0 0 0 nan 0\n0 1 0 0 0 0\n3 0 1 2\n");
    CHECK(scene.meshes[0].mesh.normals == std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}});
}

TEST_CASE("PLY: what cannot be hit is counted in text and binary alike") {
    const std::string head =
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
        "property list uchar int vertex_indices\nend_header\n";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::string binary = "ply\nformat binary_little_endian 1.0\n" + head +
                               bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0}) + "\3" +
                               bytes_of<std::int32_t>({0, 1, 2}) + "\3" + bytes_of<std::int32_t>({0, 1, 3}) +
                               "\3" + bytes_of<std::int32_t>({0, 0, 2}) + "\3" +
                               bytes_of<std::int32_t>({0, -1, 2});
    const std::string text = "ply\nformat ascii 1.0\n" + head +
                             "0 0 0\n1 0 0\n0 1 0\n-nan(ind) 0 0\n3 0 1 2\n3 0 1 3\n3 0 0 2\n3 0 -1 2\n";
    for (const std::string& bytes : {binary, text}) {
        const ImportedScene scene = import_text("a.ply", bytes);
        CHECK(scene.report.faces == 4);
        CHECK(scene.report.triangles == 1);
        CHECK(scene.report.not_finite == 1);
        CHECK(scene.report.degenerate == 1);
        CHECK(scene.report.index_out_of_range == 1);
        CHECK(scene.meshes[0].mesh.positions.size() == 4);
    }
}

TEST_CASE("OFF: its headers, comments, colours and bad faces") {
    const std::string body = "0 0 0\n2 0 0\n2 2 0\n0 2 0\n4 0 1 2 3\n";
    check_square(import_text("a.off", "OFF\n4 1 4\n" + body));
    check_square(import_text("a.off", "OFF 4 1 4\n" + body));
    check_square(import_text("a.off", "OFF4 1 0\n" + body));
    check_square(import_text("a.off", "OFF\n4 1\n" + body));
    check_square(import_text("a.off", "OFF\n4 1\n4\n" + body));
    check_square(import_text("a.off",
                             "# made by\nCOFF\n# counts\n4 1 0\n\n0 0 0 1 0 0 1\n2 0 0 0.5 0 0 1 # red\n"
                             "2 2 0 255 0 0\n0 2 0\n4 0 1 2 3 255 0 0\n"));
    const ImportedScene normals =
        import_text("a.off", "NOFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 1 0 0\n3 0 1 2\n");
    for (const glm::vec3& n : normals.meshes[0].mesh.normals) CHECK(n == glm::vec3(1, 0, 0));
    const ImportedScene bad = import_text(
        "a.off", "OFF\n4 5 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 7\n3 0 -1 2\n3 0 1 3\n2 0 1\n");
    CHECK(bad.report.triangles == 1);
    CHECK(bad.report.index_out_of_range == 2);
    CHECK(bad.report.not_finite == 1);
    CHECK(bad.report.degenerate == 1);
}

TEST_CASE("STL: text and binary are welded, also binary that starts with 'solid'") {
    const std::string facet = stl_facet({kSquare[0], kSquare[1], kSquare[2]}),
                      other = stl_facet({kSquare[0], kSquare[2], kSquare[3]});
    const std::string text =
        "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 2 2 "
        "0\nendloop\nendfacet\n"
        "FACET NORMAL -nan 0 1\n OUTER LOOP\n VERTEX 0 0 0\nVERTEX 2 2 0\nVERTEX 0 2 "
        "0\nENDLOOP\nENDFACET\nendsolid a b\n";
    for (const std::string& bytes :
         {binary_stl("made by", {facet, other}), binary_stl("solid", {facet, other}), text}) {
        const ImportedScene scene = import_text("a.stl", bytes);
        CHECK(scene.meshes[0].mesh.positions == kSquare);
        CHECK(scene.meshes[0].mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}});
        CHECK(scene.report.faces == 2);
    }
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const ImportedScene bad =
        import_text("a.stl", binary_stl("", {stl_facet({{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}), facet, facet,
                                             stl_facet({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}),
                                             stl_facet({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})}));
    CHECK(bad.report.faces == 5);
    CHECK(bad.report.triangles == 2);
    CHECK(bad.report.not_finite == 1);
    CHECK(bad.report.degenerate == 2);
    CHECK(area(bad.meshes[0].mesh) == Approx(4));
}

TEST_CASE("the crease angle reaches the normals of files without any") {
    const TestFolder folder;
    const auto path = folder.write("a.obj", "v 0 0 0\nv 1 0 1\nv 1 1 1\nv 2 0 0\nf 1 2 3\nf 3 2 4\n");
    CHECK(import_scene(path).meshes[0].mesh.positions.size() == 4);
    CHECK(import_scene(path, {.crease_degrees = 45}).meshes[0].mesh.positions.size() == 6);
}
