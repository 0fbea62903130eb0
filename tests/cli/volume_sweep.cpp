// `dfield volume sweep` and `dfield volume compare` as a user runs them.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <map>

#include "baker/volume/read_volume.hpp"
#include "models/volumes.hpp"
#include "tests/cli/command.hpp"

using namespace dfield::test;
namespace models = dfield::models;

namespace {

const std::string kPlain = "spacings: 1 1 1\n";

template<class T = float>
std::string nrrd(const models::ScalarVolume& volume, const std::string& place = kPlain,
                 const std::string& type = "float") {
    const auto size = [&](std::size_t axis) { return " " + std::to_string(volume.dims[axis]); };
    std::string bytes = "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes:" + size(0) + size(1) + size(2) +
                        "\n" + place + "endian: little\nencoding: raw\n\n";
    for (const float value : volume.values) bytes += bytes_of<T>({static_cast<T>(value)});
    return bytes;
}

// Boxes on a floor: nothing about it is symmetric.
models::ScalarVolume boxes() {
    return models::floor_volume({20, 18, 16});
}

std::vector<float> values_of(const std::filesystem::path& path) {
    return float_values(dfield::read_volume(path));
}

std::string file_bytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Sweeps `input` into out.nrrd and returns it.
std::vector<float> sweep(const Shell& shell, const std::string& input, Arguments more) {
    Arguments arguments{"volume", "sweep", input, "--iso", "0", "-o", "out.nrrd"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return values_of(shell.folder() / "out.nrrd");
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b, float scale = 1) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::fabs(double{a[i]} - double{scale * b[i]}));
    return largest;
}

}  // namespace

TEST_CASE("volume sweep: visibility and distances on the input's grid") {
    const Shell shell;
    // Inside below z = 5.25 voxels; world z falls as the voxels' rises.
    const models::ScalarVolume plane = models::plane_volume({12, 10, 16}, {0, 0, 5.25}, {0, 0, 1});
    shell.write("plane.nrrd",
                nrrd(plane,
                     "space: left-posterior-superior\nspace directions: (0,2,0) (2,0,0) (0,0,-3)\n"
                     "space origin: (5,6,7)\nspace units: \"mm\" \"mm\" \"mm\"\n"));
    const Run run = shell.run({"volume", "sweep", "plane.nrrd", "--iso", "0", "-o", "ao.nrrd", "--sdf",
                               "sdf.nrrd", "--threads", "1", "--json", "-"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Json json = run.json();
    CHECK(json["file"] == "plane.nrrd");
    CHECK(json["output"] == "ao.nrrd");
    CHECK(json["sdf"] == "sdf.nrrd");
    CHECK(!json.contains("octant_volume"));
    CHECK(json["voxels"] == 12 * 10 * 16);
    CHECK(json["form"] == "improved");
    CHECK(json["threads"] == 1);
    CHECK(json["seconds_sdf"] > 0);
    const double both = json["seconds_sdf"].get<double>() + json["seconds_occlusion"].get<double>();
    CHECK(json["mvoxels_per_s"].get<double>() == Approx(12 * 10 * 16 / both / 1e6).epsilon(0.001));
    CHECK(json["overhead_fraction"].get<double>() ==
          Approx(json["seconds_occlusion"].get<double>() / json["seconds_sdf"].get<double>()).epsilon(0.001));

    const dfield::Volume input = dfield::read_volume(shell.folder() / "plane.nrrd");
    for (const char* name : {"ao.nrrd", "sdf.nrrd"}) {
        INFO(name);
        CHECK(contains(file_bytes(shell.folder() / name), "encoding: raw"));
        const dfield::Volume output = dfield::read_volume(shell.folder() / name);
        CHECK(output.type == dfield::VoxelType::kF32);
        CHECK(output.grid.size == input.grid.size);
        CHECK(output.grid.directions == input.grid.directions);
        CHECK(output.grid.origin == input.grid.origin);
        CHECK(output.grid.space == input.grid.space);
        CHECK(output.grid.unit == input.grid.unit);
    }
    const std::vector<float> visibility = values_of(shell.folder() / "ao.nrrd");
    const std::vector<float> distance = values_of(shell.folder() / "sdf.nrrd");
    for (std::size_t z = 0; z < 16; ++z) {
        const std::size_t voxel = plane.index(5, 5, z);
        CHECK(distance[voxel] == Approx(3 * (static_cast<double>(z) - 5.25)).margin(1e-4));
        CHECK(visibility[voxel] >= 0);
        if (z >= 6) CHECK(visibility[voxel] > 0.98);
    }
    CHECK(visibility[plane.index(5, 5, 0)] < 0.1);
}

TEST_CASE("volume sweep: octants, intensities, gamma, band") {
    const Shell shell;
    shell.write("boxes.nrrd", nrrd(boxes()));
    const std::vector<float> open = sweep(shell, "boxes.nrrd", {"--form", "paper"});
    CHECK(*std::min_element(open.begin(), open.end()) < 0.5);

    const std::vector<float> upper = sweep(shell, "boxes.nrrd", {"--form", "paper", "--octants", "4,5,6,7"});
    const std::vector<float> lower = sweep(shell, "boxes.nrrd", {"--form", "paper", "--octants", "3,1,0,2"});
    std::vector<float> sum = upper;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += lower[i];
    CHECK(largest_difference(sum, open) < 1e-4);
    CHECK(largest_difference(upper, lower) > 0.5);
    CHECK(largest_difference(sweep(shell, "boxes.nrrd", {"--form", "paper", "--intensity", "0.25"}), open,
                             0.25f) < 1e-5);
    // The list of intensities goes with that of octants.
    CHECK(largest_difference(
              sweep(shell, "boxes.nrrd", {"--form", "paper", "--octants", "7,0", "--intensity", "0.5,0"}),
              sweep(shell, "boxes.nrrd", {"--form", "paper", "--octants", "7"}), 0.5f) < 1e-5);
    std::vector<float> roots = open;
    for (float& value : roots) value = std::sqrt(value);
    CHECK(largest_difference(sweep(shell, "boxes.nrrd", {"--form", "paper", "--gamma", "2"}), roots) < 1e-5);
    // Through matter that is half clear more light comes.
    const std::vector<float> clear = sweep(shell, "boxes.nrrd", {"--form", "paper", "--alpha", "0.5"});
    CHECK(*std::min_element(clear.begin(), clear.end()) > *std::min_element(open.begin(), open.end()));
    CHECK(sweep(shell, "boxes.nrrd", {"--octants", "combined"}) ==
          sweep(shell, "boxes.nrrd", {"--form", "combined"}));
    CHECK(sweep(shell, "boxes.nrrd", {"--form", "improved-48"}) != sweep(shell, "boxes.nrrd", {}));

    sweep(shell, "boxes.nrrd",
          {"--form", "paper", "--sdf", "near.nrrd", "--band", "2", "--octant-volume", "octants.nrrd"});
    const std::vector<float> distance = values_of(shell.folder() / "near.nrrd");
    CHECK(*std::max_element(distance.begin(), distance.end()) == 2);
    const std::string octants = file_bytes(shell.folder() / "octants.nrrd");
    CHECK(contains(octants, "sizes: 20 18 16 8\n"));
    CHECK(contains(octants, "type: unsigned char\n"));
    // At the ceiling the sky above is open, the floor below is not.
    const std::size_t voxels = 20 * 18 * 16;
    const auto* values = reinterpret_cast<const std::uint8_t*>(octants.data() + octants.size() - 8 * voxels);
    for (std::size_t octant = 0; octant < 8; ++octant) {
        INFO("octant " << octant);
        const int value = values[octant * voxels + boxes().index(10, 9, 15)];
        if (octant >= 4)
            CHECK(value == 255);
        else
            CHECK(value < 255);
    }
}

TEST_CASE("volume sweep: neither threads, encoding nor the voxels' type change the values") {
    const Shell shell;
    models::ScalarVolume volume = boxes();
    for (float& value : volume.values) value = std::round(10 * value);
    shell.write("f32.nrrd", nrrd(volume));
    shell.write("i8.nrrd", nrrd<std::int8_t>(volume, kPlain, "signed char"));
    shell.write("i16.nrrd", nrrd<std::int16_t>(volume, kPlain, "short"));
    shell.write("i32.nrrd", nrrd<std::int32_t>(volume, kPlain, "int"));
    shell.write("f64.nrrd", nrrd<double>(volume, kPlain, "double"));
    const std::vector<float> expected = sweep(shell, "f32.nrrd", {"--threads", "1"});
    CHECK(sweep(shell, "f32.nrrd", {"--threads", "3"}) == expected);
    for (const char* name : {"i8.nrrd", "i16.nrrd", "i32.nrrd", "f64.nrrd"}) {
        INFO(name);
        CHECK(sweep(shell, name, {}) == expected);
    }
    CHECK(sweep(shell, "f32.nrrd", {"--gzip"}) == expected);
    CHECK(contains(file_bytes(shell.folder() / "out.nrrd"), "encoding: gzip"));
}

TEST_CASE("volume sweep: the light is of the world, however the grid lies in it") {
    const Shell shell;
    const models::ScalarVolume volume = boxes();
    const auto place = [](const std::string& directions) {
        return "space: right-anterior-superior\nspace directions: " + directions +
               "\nspace origin: (0,0,0)\n";
    };
    shell.write("straight.nrrd", nrrd(volume, place("(1,0,0) (0,1,0) (0,0,1)")));
    shell.write("mirrored.nrrd", nrrd(volume, place("(-1,0,0) (0,1,0) (0,0,1)")));
    shell.write("turned.nrrd", nrrd(volume, place("(0,1,0) (0,0,1) (1,0,0)")));
    shell.write("oblique.nrrd", nrrd(volume, place("(1,0,0) (0,1,0) (0.6,0,0.8)")));
    const std::vector<float> lit = sweep(shell, "straight.nrrd", {"--light", "-0.5,0.25,1"});
    CHECK(*std::min_element(lit.begin(), lit.end()) < 0.3);
    CHECK(*std::max_element(lit.begin(), lit.end()) > 0.9);
    CHECK(largest_difference(sweep(shell, "straight.nrrd", {"--light", "0.5,0.25,1"}), lit) > 0.3);
    CHECK(sweep(shell, "straight.nrrd", {"--light", "-1", "0.5", "2"}) == lit);
    CHECK(largest_difference(sweep(shell, "mirrored.nrrd", {"--light", "0.5,0.25,1"}), lit) < 1e-5);
    CHECK(largest_difference(sweep(shell, "turned.nrrd", {"--light", "1,-0.5,0.25"}), lit) < 1e-5);
    // Voxel (-0.5, 0.25, 1) of the sheared grid lies at (-0.5 + 0.6, 0.25, 0.8).
    CHECK(largest_difference(sweep(shell, "oblique.nrrd", {"--light", "0.1,0.25,0.8"}), lit) < 1e-4);
    const Run run = shell.run({"volume", "sweep", "oblique.nrrd", "--iso", "0", "-o", "out.nrrd"});
    CHECK(contains(run.err, "oblique.nrrd: its axes are not perpendicular"));
}

TEST_CASE("volume compare: every form against rays") {
    const Shell shell;
    shell.write("gyroid.nrrd", nrrd(models::gyroid_volume({48, 48, 48}, 2)));
    const Arguments arguments{"volume",   "compare", "gyroid.nrrd",   "--iso", "0",      "--rays", "128",
                              "--points", "500",     "--repetitions", "1",     "--json", "-"};
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(contains(run.err, "correlation"));
    CHECK(contains(run.err, "improved-48"));
    const Json json = run.json();
    CHECK(json["points"] == 500);
    CHECK(json["crossings"] > 5000);
    CHECK(json["rays"] == 128);
    std::map<std::string, Json> forms;
    for (const Json& form : json["forms"]) forms[form["form"]] = form;
    REQUIRE(forms.size() == 4);
    for (const auto& [name, form] : forms) {
        INFO(name);
        CHECK(form["seconds"] > 0);
        CHECK(std::fabs(form["bias"].get<double>()) <= form["rms"].get<double>());
        CHECK(form["correlation"] > 0.8);
        CHECK(form["correlation"] <= 1);
    }
    CHECK(forms["improved"]["rms"] < 0.04);
    CHECK(forms["improved"]["rms"] < forms["paper"]["rms"]);
    CHECK(forms["paper"]["rms"] < 0.3);

    // The same again, but for the seconds.
    const Json again = shell.run(arguments).json();
    for (std::size_t i = 0; i < 4; ++i)
        for (const char* key : {"form", "rms", "correlation", "bias"})
            CHECK(json["forms"][i][key] == again["forms"][i][key]);

    // Seen from a plane the sky is open everywhere: nothing varies that could correlate.
    shell.write("plane.nrrd", nrrd(models::plane_volume({12, 12, 12}, {0, 0, 5.25}, {0, 0, 1})));
    const Run flat = shell.run({"volume", "compare", "plane.nrrd", "--iso", "0", "--json", "-"});
    REQUIRE(flat.exit_code == 0);
    CHECK(flat.json()["forms"][0]["rms"] < 0.01);
    CHECK(flat.json()["forms"][0]["correlation"].is_null());
}

TEST_CASE("volume sweep and compare: mistakes leave nothing behind") {
    const Shell shell;
    shell.write("a.nrrd", nrrd(models::plane_volume({4, 4, 4}, {0, 0, 1.5}, {0, 0, 1})));
    shell.write("rim.nrrd", nrrd(models::plane_volume({12, 12, 12}, {0, 0, 0.5}, {0, 0, 1})));
    shell.write("long.nrrd",
                nrrd(models::plane_volume({4, 4, 4}, {0, 0, 1.5}, {0, 0, 1}), "spacings: 1 1 2000\n"));
    struct Mistake {
        Arguments arguments;
        int exit_code;
        std::string said;
    };
    const auto sweeping = [](Arguments more) {
        Arguments arguments{"volume", "sweep", "a.nrrd", "-o", "o.nrrd"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    };
    const auto at_zero = [&](Arguments more) {
        more.emplace_back("--iso");
        more.emplace_back("0");
        return sweeping(more);
    };
    for (const auto& [arguments, exit_code, said] : std::vector<Mistake>{
             {{"volume", "sweep", "a.nrrd", "--iso", "0"}, 2, "--output is required"},
             {sweeping({}), 2, "--iso is required"},
             {sweeping({"--iso", "nan"}), 2, "--iso"},
             {sweeping({"--iso", "300"}), 2, "values go from -1.5 to 1.5"},
             {sweeping({"--iso", "-1.5"}), 2, "values go from -1.5 to 1.5"},
             {at_zero({"--form", "best"}), 2, "--form"},
             {at_zero({"--octants", "8"}), 2, "0 to 7"},
             {at_zero({"--octants", "-1"}), 2, "0 to 7"},
             {at_zero({"--octants", "1,1"}), 2, "each named once"},
             {at_zero({"--octants", "1,"}), 2, "'1,' is no list"},
             {at_zero({"--octants", "some"}), 2, "'some' is no list"},
             {at_zero({"--octants", "combined", "--form", "paper"}), 2, "--form combined"},
             {at_zero({"--intensity", "1,2"}), 2, "are 2, but 8 octants shine"},
             {at_zero({"--intensity", "-1"}), 2, "0 or above"},
             {at_zero({"--intensity", "inf"}), 2, "0 or above"},
             {at_zero({"--intensity", "1;2"}), 2, "'1;2' is no list"},
             {at_zero({"--gamma", "0"}), 2, "--gamma"},
             {at_zero({"--alpha", "1.5"}), 2, "--alpha"},
             {at_zero({"--band", "0"}), 2, "--band"},
             {at_zero({"--light", "0,0,0"}), 2, "no direction"},
             {at_zero({"--light", "0,1"}), 2, "--light"},
             {at_zero({"--light", "0,1,nan"}), 2, "--light"},
             {at_zero({"--light", "0,0,1", "--octants", "1"}), 2, "--octants"},
             {at_zero({"--light", "0,0,1", "--octant-volume", "p.nrrd"}), 2, "not kept apart"},
             {at_zero({"--form", "combined", "--octant-volume", "p.nrrd"}), 2, "not kept apart"},
             {at_zero({"--sdf", "o.nrrd"}), 2, "two outputs"},
             {at_zero({"--sdf", "sdf.nhdr"}), 2, ".nrrd"},
             {{"volume", "sweep", "none.nrrd", "--iso", "0", "-o", "o.nrrd"}, 3, "no such file"},
             {{"volume", "sweep", "long.nrrd", "--iso", "0", "-o", "o.nrrd"}, 3, "long.nrrd: "},
             {{"volume", "sweep", "a.nrrd", "--iso", "0", "-o", "none/o.nrrd"}, 4, "does not exist"},
             {at_zero({"--sdf", "none/sdf.nrrd"}), 4, "does not exist"},
             {{"volume", "compare", "a.nrrd"}, 2, "--iso is required"},
             {{"volume", "compare", "a.nrrd", "--iso", "2"}, 2, "values go from -1.5 to 1.5"},
             {{"volume", "compare", "a.nrrd", "--iso", "0", "--rays", "0"}, 2, "--rays"},
             {{"volume", "compare", "a.nrrd", "--iso", "0", "--points", "0"}, 2, "--points"},
             {{"volume", "compare", "rim.nrrd", "--iso", "0"}, 3, "no surface at 0 but in the 2 voxels"}})
        check_mistake(shell, arguments, exit_code, said);
}
