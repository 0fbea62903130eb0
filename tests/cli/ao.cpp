// dfield ao: which values end up where, how often fields are baked, and that lookup and ray casting agree.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"
#include "tests/gltf/gltf_reader.hpp"
#include "tests/test_data.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

Run ao(const Shell& shell, const std::string& scene, const std::string& output, const Arguments& more = {}) {
    Arguments arguments{"ao", scene, "-o", output, "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run;
}

// _OCCLUSION of every primitive of every node with a mesh, in the file's order. Each must be a float SCALAR
// in [0, 1], one for each position; no mesh may serve two nodes.
std::vector<double> occlusion_of(const fs::path& path) {
    const GltfFile file = read_gltf(path);
    std::vector<double> all;
    std::vector<bool> used(file.json.at("meshes").size(), false);
    for (const Json& node : file.json.at("nodes")) {
        if (!node.contains("mesh")) continue;
        const auto mesh = node.at("mesh").get<std::size_t>();
        CHECK(!used.at(mesh));
        used[mesh] = true;
        for (const Json& primitive : file.json["meshes"][mesh].at("primitives")) {
            const Json& attributes = primitive.at("attributes");
            REQUIRE(attributes.contains("_OCCLUSION"));
            const auto index = attributes.at("_OCCLUSION").get<std::size_t>();
            const Json& accessor = file.json["accessors"].at(index);
            CHECK(accessor.at("componentType") == 5126);
            CHECK(accessor.at("type") == "SCALAR");
            const std::vector<double> values = file.accessor(index);
            CHECK(values.size() ==
                  file.json["accessors"].at(attributes.at("POSITION").get<std::size_t>()).at("count"));
            CHECK(std::all_of(values.begin(), values.end(), [](double v) { return v >= 0 && v <= 1; }));
            all.insert(all.end(), values.begin(), values.end());
        }
    }
    return all;
}

struct Difference {
    double rms = 0, bias = 0;
};

// In grey levels, 0..255.
Difference grey_difference(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    Difference difference;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double grey = 255 * (a[i] - b[i]);
        difference.rms += grey * grey / static_cast<double>(a.size());
        difference.bias += grey / static_cast<double>(a.size());
    }
    difference.rms = std::sqrt(difference.rms);
    return difference;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string model(const char* name) {
    return source_file(std::string("models/") + name).string();
}

const Arguments kField{"--subdivision", "24", "--map-size", "24", "--rays", "64"};
// Grey levels of 255, measured (11.71, +0.80, 4.22) and 15% more. By lookup an object's own shadow is
// multiplied with that of others as if they fell independently: most of the difference. By direction maps
// they are united (2.04, -0.08; by fewer rays, which all vertices share, what one of them gets wrong does not
// average out: 4.07, +0.48 by 96).
constexpr double kLimitRmsUnited = 2.35, kLimitBiasUnited = 0.2;
constexpr double kLimitRms = 13.5, kLimitBias = 0.95, kLimitRmsNoSelf = 4.9;

}  // namespace

TEST_CASE("ao of a scene with instances: lookup agrees with ray casting, each mesh is baked once") {
    const Shell shell;
    const std::string scene = model("scene_instances.glb");
    const Run first = ao(shell, scene, "lookup.glb", kField);
    const Json json = first.json();
    CHECK(json.at("scene") == scene);
    CHECK(json.at("output") == "lookup.glb");
    CHECK(json.at("method") == "lookup");
    CHECK(json.at("meshes") == 3);
    CHECK(json.at("instances") == 9);
    CHECK(json.at("rays_per_vertex") == 64);
    CHECK(json.at("self") == true);
    CHECK(json.at("fields_baked") == 3);
    CHECK(json.at("fields_from_cache") == 0);
    CHECK(number(json, "field_bytes", 3 * 2306 * 576, 3 * 2306 * 576 + 1e6) > 0);
    for (const char* seconds : {"bake_seconds", "self_seconds", "visibility_seconds"})
        number(json, seconds, 0, 100);
    const std::vector<double> lookup = occlusion_of(shell.folder() / "lookup.glb");
    CHECK(json.at("vertices") == lookup.size());
    CHECK(number(json, "mean_visibility", 0, 1) == Approx(mean(lookup)).epsilon(0.02));
    CHECK(std::distance(fs::directory_iterator(shell.cache()), fs::directory_iterator()) == 3);

    const Json again = ao(shell, scene, "again.glb", kField).json();
    CHECK(again.at("fields_baked") == 0);
    CHECK(again.at("fields_from_cache") == 3);
    CHECK(occlusion_of(shell.folder() / "again.glb") == lookup);
    const Json uncached =
        ao(shell, scene, "uncached.glb",
           {"--no-cache", "--subdivision", "2", "--map-size", "2", "--rays", "1", "--no-self"})
            .json();
    CHECK(uncached.at("fields_baked") == 3);
    CHECK(std::distance(fs::directory_iterator(shell.cache()), fs::directory_iterator()) == 3);

    Arguments rays = kField;
    rays.insert(rays.end(), {"--method", "rays"});
    const Json reference = ao(shell, scene, "rays.glb", rays).json();
    CHECK(reference.at("method") == "rays");
    CHECK(reference.at("fields_baked").get<int>() + reference.at("fields_from_cache").get<int>() == 0);
    const Difference all = grey_difference(lookup, occlusion_of(shell.folder() / "rays.glb"));
    std::printf("ao by lookup against rays: %.2f grey RMS, bias %+.2f\n", all.rms, all.bias);
    CHECK(all.rms < kLimitRms);
    CHECK(std::fabs(all.bias) < kLimitBias);

    // Without an object's own shadow everything is lighter or equal, and the two methods still agree.
    Arguments others = kField, other_rays = rays;
    others.push_back("--no-self");
    other_rays.push_back("--no-self");
    CHECK(ao(shell, scene, "others.glb", others).json().at("self") == false);
    ao(shell, scene, "other_rays.glb", other_rays);
    const std::vector<double> without = occlusion_of(shell.folder() / "others.glb");
    const Difference no_self = grey_difference(without, occlusion_of(shell.folder() / "other_rays.glb"));
    std::printf("the same without self-occlusion: %.2f grey RMS, bias %+.2f\n", no_self.rms, no_self.bias);
    CHECK(no_self.rms < kLimitRmsNoSelf);
    CHECK(mean(without) > mean(lookup) + 0.1);
    bool lighter = true;
    for (std::size_t i = 0; i < lookup.size(); ++i) lighter = lighter && without[i] >= lookup[i] - 1e-6;
    CHECK(lighter);
}

TEST_CASE("ao by direction maps unites an object's own shadow with that of others") {
    const Shell shell;
    const std::string scene = model("scene_instances.glb");
    const Arguments shared{"--rays", "512"};
    const auto with = [&](const std::string& output, Arguments more) {
        more.insert(more.end(), shared.begin(), shared.end());
        return ao(shell, scene, output, more).json();
    };
    const Json json = with("lookup.glb", {"--direction-count", "402"});
    CHECK(json.at("kind") == "directions");  // auto
    CHECK(json.at("sampling") == "shared");
    CHECK(json.at("rays_per_vertex") == 512);
    const Json rays = with("rays.glb", {"--method", "rays"});
    CHECK(rays.at("kind") == "none");
    CHECK(rays.at("sampling") == "shared");
    const Difference difference = grey_difference(occlusion_of(shell.folder() / "lookup.glb"),
                                                  occlusion_of(shell.folder() / "rays.glb"));
    std::printf("ao by direction maps against rays: %.2f grey RMS, bias %+.2f\n", difference.rms,
                difference.bias);
    CHECK(difference.rms < kLimitRmsUnited);
    CHECK(std::fabs(difference.bias) < kLimitBiasUnited);

    // Finer maps alone: the depths, by which vertices within the spheres see, are finer with them.
    with("finer.glb", {"--direction-count", "402", "--direction-size", "64"});
    const Difference finer = grey_difference(occlusion_of(shell.folder() / "finer.glb"),
                                             occlusion_of(shell.folder() / "rays.glb"));
    CHECK(finer.rms < difference.rms);
    CHECK(std::fabs(finer.bias) < kLimitBiasUnited);
}

TEST_CASE("ao --kind: what answers, and what auto takes") {
    const Shell shell;
    const auto answer = [&](const Arguments& more, const char* rays = "16") {
        Arguments arguments{"--ground", "-0.5", "--rays", rays};
        arguments.insert(arguments.end(), more.begin(), more.end());
        SmallGltf gltf;
        Json& nodes = gltf.json["nodes"];
        gltf.json["scenes"][0]["nodes"].push_back(nodes.size());
        nodes.push_back({{"name", "above"}, {"mesh", 0}, {"translation", {0, 0, 0.5}}});
        gltf.write_glb(shell.folder() / "two.glb");
        return ao(shell, "two.glb", "out.glb", arguments).json();
    };
    CHECK(answer({}).at("kind") == "directions");
    CHECK(answer({"--max-distance", "1"}).at("kind") == "maps");
    CHECK(answer({"--bias", "0.1"}).at("kind") == "maps");
    CHECK(answer({"--map-size", "8", "--subdivision", "4"}).at("kind") == "maps");
    CHECK(answer({}, "4097").at("kind") == "maps");
    for (const std::string kind : {"maps", "lines", "directions"}) {
        const Json json = answer({"--kind", kind});
        CHECK(json.at("kind") == kind);
        CHECK(json.at("sampling") == (kind == "directions" ? "shared" : "hemisphere"));
        // One quad 0.5 over another: each kind sees the same.
        CHECK(json.at("mean_visibility").get<double>() ==
              Approx(answer({"--method", "rays", "--kind", kind}).at("mean_visibility").get<double>())
                  .margin(0.03));
        CHECK(answer({"--kind", kind, "--max-distance", "0.6"}).at("kind") == kind);
    }
    const Json volume = answer({"--kind", "volume", "--volume-size", "32"});
    CHECK(volume.at("kind") == "volume");
    CHECK(volume.at("sampling") == "hemisphere");
    CHECK(volume.at("mean_visibility").get<double>() ==
          Approx(answer({"--method", "rays", "--kind", "maps"}).at("mean_visibility").get<double>())
              .margin(0.06));
}

TEST_CASE("ao of a model without nodes, to GLB and to PLY") {
    const Shell shell;
    // Flat sides: the hole's walls are concave.
    Arguments field = kField;
    field.insert(field.end(), {"--crease", "30"});
    ao(shell, "cube.obj", "cube.glb", field);
    const std::vector<double> values = occlusion_of(shell.folder() / "cube.glb");
    REQUIRE(values.size() == 48);
    CHECK(shell.list() == std::vector<std::string>{"cube.glb", "cube.obj"});
    ao(shell, "cube.obj", "cube.ply", field);

    std::ifstream file(shell.folder() / "cube.ply", std::ios::binary);
    const std::string ply((std::istreambuf_iterator<char>(file)), {});
    const std::size_t body = ply.find("end_header\n") + 11;
    const std::string header = ply.substr(0, body);
    for (const char* line : {"format binary_little_endian 1.0\n", "element vertex 48\n", "element face 32\n",
                             "property float quality\n", "property uchar red\n", "property uchar blue\n"})
        CHECK(contains(header, line));
    constexpr std::size_t kVertex = 7 * 4 + 3;  // x y z nx ny nz quality, red green blue
    REQUIRE(ply.size() == body + 48 * kVertex + 32 * 13);
    for (std::size_t v = 0; v < 48; ++v) {
        float quality = 0;
        std::memcpy(&quality, ply.data() + body + v * kVertex + 24, 4);
        CHECK(static_cast<double>(quality) == values[v]);
        for (int channel = 0; channel < 3; ++channel) {
            const int grey = static_cast<unsigned char>(ply[body + v * kVertex + 28 + channel]);
            CHECK(std::abs(grey - 255 * quality) <= 0.51);
        }
    }
    // The outside is open; the hole's four walls shadow each other at their sixteen vertices.
    CHECK(std::count_if(values.begin(), values.end(), [](double v) { return v == 1; }) == 32);
    CHECK(std::count_if(values.begin(), values.end(), [](double v) { return v > 0.1 && v < 0.6; }) == 16);
}

TEST_CASE("ao --color writes greys beside the attribute, and only then") {
    const Shell shell;
    const auto colours = [&](const std::string& output, const Arguments& more) {
        Arguments arguments = with_small_field({"--rays", "16"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        ao(shell, model("scene_instances.glb"), output, arguments);
        const GltfFile file = read_gltf(shell.folder() / output);
        std::size_t count = 0;
        for (const Json& mesh : file.json.at("meshes"))
            for (const Json& primitive : mesh.at("primitives")) {
                if (!primitive.at("attributes").contains("COLOR_0")) continue;
                const auto& attributes = primitive.at("attributes");
                const std::size_t colour = attributes.at("COLOR_0").get<std::size_t>();
                const std::vector<double> grey = file.accessor(colour),
                                          open =
                                              file.accessor(attributes.at("_OCCLUSION").get<std::size_t>());
                const Json& accessor = file.json["accessors"].at(colour);
                const std::size_t channels = accessor.at("type") == "VEC3" ? 3 : 4;
                const int type = accessor.at("componentType").get<int>();
                const double one = type == 5121 ? 255 : type == 5123 ? 65535 : 1;
                REQUIRE(grey.size() == channels * open.size());
                bool same = true;
                for (std::size_t i = 0; i < open.size(); ++i)
                    same = same && std::fabs(grey[channels * i] / one - open[i]) <= 0.51 / 255;
                CHECK(same);
                ++count;
            }
        return count;
    };
    CHECK(colours("plain.glb", {}) == 0);
    CHECK(colours("colour.glb", {"--color"}) == 1 + 3 * 2 + 5);
}

TEST_CASE("ao options darken and lighten as they should") {
    const Shell shell;
    shell.write("open.txt", "1 1\n");
    shell.write("closed.txt", "0 0\n");
    const auto mean_of = [&](const Arguments& more) {
        Arguments arguments = kField;
        arguments.insert(arguments.end(), {"--crease", "30"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return ao(shell, "cube.obj", "out.glb", arguments).json().at("mean_visibility").get<double>();
    };
    const double plain = mean_of({});
    CHECK(plain > 0.7);
    CHECK(plain < 1);
    CHECK(mean_of({"--no-self"}) == 1);
    // The ground at the cube's lower side: half of its vertices lie in it.
    const double ground = mean_of({"--ground", "-0.5"});
    CHECK(ground < plain - 0.2);
    CHECK(mean_of({"--ground-plane", "0", "2", "0", "-1"}) == Approx(ground).epsilon(1e-4));
    CHECK(mean_of({"--ground-plane", "0", "0", "1", "-0.5"}) ==
          Approx(mean_of({"--ground", "-0.5", "--up", "z"})).epsilon(1e-4));
    // Below everything but within sight of every side.
    const double low = mean_of({"--ground", "-1"});
    CHECK(low < plain - 0.2);
    CHECK(mean_of({"--ground", "-1", "--max-distance", "0.25"}) > plain);

    const auto falloff = [&](const char* name, const Arguments& more = {}) {
        Arguments arguments{"--max-distance", "2", "--ground", "-0.5", "--falloff", name};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return mean_of(arguments);
    };
    const double none = falloff("none"), linear = falloff("linear"), smooth = falloff("smooth"),
                 exponential = falloff("exponential");
    CHECK(none < smooth);
    CHECK(smooth < linear + 0.05);
    CHECK(linear < exponential);  // rate 3 falls below the straight line everywhere
    CHECK(exponential < 1);
    CHECK(falloff("exponential", {"--falloff-rate", "10"}) > exponential);
    CHECK(falloff("table", {"--falloff-table", "closed.txt"}) == Approx(none).epsilon(1e-3));
    CHECK(falloff("table", {"--falloff-table", "open.txt"}) == 1);
    CHECK(mean_of({"--max-distance", "0.01"}) >= plain);
    CHECK(mean_of({"--bias", "0.7"}) > plain);  // what occludes here is nearer than that
    // By rays, the same.
    CHECK(mean_of({"--method", "rays", "--ground", "-0.5"}) == Approx(ground).epsilon(0.02));
    CHECK(mean_of({"--method", "rays", "--ground", "-0.5", "--max-distance", "2", "--falloff", "linear"}) ==
          Approx(linear).epsilon(0.06));
}

TEST_CASE("ao with one ray, with odd numbers of rays, and with many") {
    const Shell shell;
    for (const char* rays : {"1", "2", "7", "17", "65536"}) {
        INFO(rays);
        for (const char* method : {"lookup", "rays"})
            CHECK(ao(shell, "cube.obj", "out.glb", with_small_field({"--rays", rays, "--method", method}))
                      .json()
                      .at("rays_per_vertex") == std::stoi(rays));
    }
}

TEST_CASE("ao finds the same in its own output, in .gltf, and on the next run in place") {
    const Shell shell;
    const Arguments field = with_small_field({"--rays", "16"});
    ao(shell, model("scene_instances.glb"), "scene.glb", field);
    const std::vector<double> values = occlusion_of(shell.folder() / "scene.glb");
    ao(shell, "scene.glb", "scene.gltf", field);
    CHECK(occlusion_of(shell.folder() / "scene.gltf") == values);
    ao(shell, "scene.glb", "scene.glb", field);
    CHECK(occlusion_of(shell.folder() / "scene.glb") == values);
}

TEST_CASE("nodes scaled to nothing and meshes of lines only are no error") {
    const Shell shell;
    SmallGltf gltf;
    Json& nodes = gltf.json["nodes"];
    Json hidden = Json::object({{"name", "hidden"}, {"mesh", 0}, {"scale", {0, 0, 0}}}),
         flat = Json::object({{"name", "flat"}, {"mesh", 0}, {"scale", {1, 1, 0}}}),
         lines = Json::object({{"name", "lines"}, {"mesh", 1}, {"translation", {0, 0, 0.5}}});
    Json strip = gltf.json["meshes"][0];
    strip["primitives"][0]["mode"] = 1;
    gltf.json["meshes"].push_back(strip);
    for (const Json& node : {hidden, flat, lines}) {
        gltf.json["scenes"][0]["nodes"].push_back(nodes.size());
        nodes.push_back(node);
    }
    gltf.write_glb(shell.folder() / "odd.glb");
    for (const char* method : {"lookup", "rays"}) {
        const Run run =
            ao(shell, "odd.glb", "out.glb", with_small_field({"--method", method, "--image", "out.png"}));
        CHECK(contains(run.err, "'hidden' is scaled by zero"));
        CHECK(contains(run.err, "'flat' is scaled by zero"));
        CHECK(run.json().at("warnings").size() == 2);
        CHECK(run.json().at("instances") == 4);
        const std::vector<double> values = occlusion_of(shell.folder() / "out.glb");
        REQUIRE(values.size() == 4 * 4);  // lines are open
        // Nothing but the quad itself is left to occlude.
        for (const double value : values) CHECK(value == 1);
    }
}

TEST_CASE("ao of the shared scenes") {
    const Shell shell;
    struct Case {
        const char* file;
        int meshes, instances;
    };
    for (const auto& [file, meshes, instances] :
         {Case{"scenes/BoxVertexColors.glb", 1, 1}, Case{"scenes/CesiumMilkTruck.glb", 2, 3},
          Case{"scenes/lemon_grove_ext_instancing.glb", 1, 25}}) {
        const auto scene = shared_file(file);
        if (!scene) continue;
        INFO(file);
        const Json json = ao(shell, scene->string(), "out.glb", with_small_field({"--rays", "1"})).json();
        CHECK(json.at("fields_baked") == meshes);  // of the 25 trees: one
        CHECK(json.at("instances") == instances);
        const std::vector<double> values = occlusion_of(shell.folder() / "out.glb");
        CHECK(values.size() == json.at("vertices"));
        const double average = mean(values);
        CHECK(average > 0.05);
        CHECK(average <= 1);
    }
}
