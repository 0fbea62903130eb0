// Broken files without nodes: always an InputError that names the file, never more memory than the file is
// worth.
#include <catch2/catch.hpp>

#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/import/test_files.hpp"

using Catch::Contains;
using dfield::import_scene;
using dfield::InputError;
using dfield::test::bytes_of;
using dfield::test::TestFolder;

namespace {

// Either usable or an InputError that names the file; anything else fails the test.
void check_no_harm(const TestFolder& folder, const std::string& name, const std::string& bytes) {
    const auto path = folder.write(name, bytes);
    try {
        const dfield::ImportedScene scene = import_scene(path);
        for (const glm::uvec3& t : scene.meshes.at(0).mesh.triangles)
            for (int k = 0; k < 3; ++k) REQUIRE(t[k] < scene.meshes[0].mesh.positions.size());
        REQUIRE(scene.meshes[0].mesh.normals.size() == scene.meshes[0].mesh.positions.size());
    } catch (const InputError& error) {
        REQUIRE_THAT(error.what(), Contains(name));
    }
}

std::string error_of(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    const auto path = folder.write(name, bytes);
    try {
        import_scene(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

const std::string kPlyHead =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n";
const std::string kPly = "ply\nformat binary_little_endian 1.0\n" + kPlyHead +
                         bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\3" +
                         bytes_of<std::int32_t>({0, 1, 2});
const std::string kStl = std::string(80, 'x') + bytes_of<std::uint32_t>({1}) + std::string(12, '\0') +
                         bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0');
const std::string kTextStl =
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
    "0\nendloop\nendfacet\nendsolid\n";
const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

}  // namespace

TEST_CASE("empty files, files without faces and foreign files are errors") {
    for (const std::string name : {"a.obj", "a.ply", "a.off", "a.stl"}) {
        CHECK_THAT(error_of(name, ""), Contains(name));
        CHECK_THAT(error_of(name, std::string(1000, '\0')), Contains(name));
    }
    CHECK_THAT(error_of("a.obj", "v 0 0 0\n"), Contains("no usable triangle") && Contains("0 faces"));
    CHECK_THAT(error_of("a.off", "OFF\n0 0 0\n"), Contains("no usable triangle"));
    CHECK_THAT(error_of("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\nf 1 2 9\n"),
               Contains("1 without area") && Contains("1 with an index beyond"));
    CHECK_THAT(error_of("a.xyz", "x"), Contains(".xyz") && Contains(".obj"));
    CHECK_THROWS_WITH(import_scene("/nowhere/a.obj"), Contains("no such file"));
}

TEST_CASE("counts in headers are held against the file") {
    // OpenMesh asks for 12.6 GB on this one.
    CHECK_THAT(error_of("a.off", "OFF\n100000000 100000000 0\n"),
               Contains("promises") && Contains("bytes follow"));
    CHECK_THAT(error_of("a.off", "OFF\n99999999999 1 0\n"), Contains("line 2"));
    CHECK_THAT(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"), Contains("line 6"));
    for (const std::string format : {"ascii", "binary_little_endian"}) {
        const std::string head = "ply\nformat " + format + " 1.0\nelement vertex ";
        const std::string properties =
            "\nproperty float x\nproperty float y\nproperty float z\nelement face ";
        const std::string list = "\nproperty list uint int vertex_indices\nend_header\n";
        CHECK_THAT(error_of("a.ply", head + "4000000000" + properties + "1" + list), Contains("promises"));
        CHECK_THAT(error_of("a.ply", head + "0" + properties + "4000000000" + list), Contains("promises"));
        CHECK_THAT(error_of("a.ply", head + "4294967295\nelement face 1" + list), Contains("x, y and z"));
    }
    CHECK_THAT(error_of("a.ply", "ply\nformat ascii 1.0\n" + kPlyHead + "0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n"),
               Contains("more entries"));
    CHECK_THAT(error_of("a.ply", "ply\nformat ascii 1.0\n" + kPlyHead + "0 0 0\n1 0 0\n0 1 0\n-1 0 1 2\n"),
               Contains("more entries"));
    std::string stl = kStl;
    stl.replace(80, 4, "\xff\xff\xff\xff");
    CHECK_THAT(error_of("a.stl", stl), Contains("4294967295 triangles"));
}

TEST_CASE("errors say where and what") {
    CHECK_THAT(error_of("a.obj", "v 0 0 0\nv 1 0\n"), Contains("a.obj: line 2") && Contains("coordinate"));
    CHECK_THAT(error_of("a.obj", "v 0 0 1,5\n"), Contains("1,5"));
    CHECK_THAT(error_of("a.obj", "v 0 0 0\nvn 0 0 1\nf /1/1 //1 1\n"), Contains("line 3"));
    CHECK_THAT(error_of("a.obj", "v 0 0 0\nf 1 x 1\n"), Contains("line 2"));
    CHECK_THAT(error_of("a.off", "OFF BINARY\n"), Contains("binary OFF"));
    CHECK_THAT(error_of("a.off", "4OFF\n1 1 1\n"), Contains("dimensions"));
    CHECK_THAT(error_of("a.off", "FOO\n"), Contains("starts with OFF"));
    CHECK_THAT(error_of("a.ply", "plx\n"), Contains("'ply'"));
    CHECK_THAT(error_of("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n"),
               Contains("'quad'"));
    CHECK_THAT(error_of("a.ply", "ply\nelement vertex 0\nend_header\n"), Contains("no format"));
    CHECK_THAT(error_of("a.stl", kTextStl.substr(0, kTextStl.size() - 9)), Contains("cut off"));
    CHECK_THAT(
        error_of("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"),
        Contains("line 6") && Contains("'vertex'"));
    std::string huge = "v 0 0 0\nf";
    for (int i = 0; i < 70000; ++i) huge += " 1";
    CHECK_THAT(error_of("a.obj", huge + "\n"), Contains("70000 corners"));
}

TEST_CASE("every prefix of a file is read or refused, and a cut binary file is refused") {
    const TestFolder folder;
    const auto prefixes = [&](const std::string& name, const std::string& bytes) {
        for (std::size_t size = 0; size <= bytes.size(); ++size)
            check_no_harm(folder, name, bytes.substr(0, size));
    };
    prefixes("a.ply", kPly);
    prefixes("a.stl", kStl);
    prefixes("a.stl", kTextStl);
    prefixes("a.off", kOff);
    prefixes("a.obj", kObj);
    for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.ply", kPly}, {"a.stl", kStl}}) {
        CHECK(error_of(name, bytes) == "no error");
        for (std::size_t size = 0; size < bytes.size(); ++size)
            REQUIRE_THAT(error_of(name, bytes.substr(0, size)), Contains(name));
    }
}

TEST_CASE("every flipped byte of a file is read or refused") {
    const TestFolder folder;
    for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.ply", kPly},
                                      {"a.stl", kStl},
                                      {"a.stl", kTextStl},
                                      {"a.off", kOff},
                                      {"a.obj", kObj}})
        for (std::size_t at = 0; at < bytes.size(); ++at)
            for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
                std::string flipped = bytes;
                flipped[at] = static_cast<char>(flipped[at] ^ flip);
                check_no_harm(folder, name, flipped);
            }
}
