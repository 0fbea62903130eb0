// Several kinds of one object in one field.
#include "baker/plan.hpp"

#include <catch2/catch.hpp>

#include "baker/bounding_sphere.hpp"
#include "baker/error.hpp"
#include "baker/provenance.hpp"
#include "baker/scene.hpp"
#include "format/file.hpp"
#include "format/writer.hpp"
#include "tests/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;

namespace {

const FieldParameters kMaps{Positions::kSlater, 4, Mapping::kConcentric, 8, 8};
const LineParameters kLines{8, 4, 5, false, false, true};
const DirectionParameters kCoarse{2, 16, 0}, kFine{4, 16, 8};

}  // namespace

TEST_CASE("a plan bakes its kinds and nothing else") {
    const TriangleMesh box = test::box_mesh({-1, -2, -3}, {1, 2, 3});
    const DisplacementField all = bake_plan(box, {kMaps, kLines, {kCoarse, kFine}}, {});
    CHECK(all.parameters == kMaps);
    REQUIRE(all.lines);
    CHECK(all.lines->parameters == kLines);
    REQUIRE(all.directions.size() == 2);
    CHECK(all.directions[0].parameters == kCoarse);
    CHECK(all.directions[1].parameters == kFine);
    CHECK(plan_bytes({kMaps, kLines, {kCoarse, kFine}}) ==
          all.texels.size() + 4 * (all.lines->hits.size() + all.lines->depths.size()) +
              all.directions[0].memory_bytes() + all.directions[1].memory_bytes());

    BakeOptions self;
    self.self_visibility = true;
    self.self_rays = 16;
    const DisplacementField directions = bake_plan(box, {.directions = {kFine}}, self);
    CHECK(directions.parameters == kNoMaps);
    CHECK(directions.texels.empty());
    CHECK(!directions.lines);
    REQUIRE(directions.directions.size() == 1);
    CHECK(directions.directions[0].texels == all.directions[1].texels);
    CHECK(directions.self_visibility.size() == box.positions.size());
    CHECK(directions.radius == all.radius);
    CHECK(directions.bounds_max == all.bounds_max);
    const DisplacementField maps = bake_plan(box, {.maps = kMaps}, {});
    BakeOptions options;
    options.parameters = kMaps;
    CHECK(payload_hash(maps) == payload_hash(bake_field(box, options)));
    CHECK(maps.provenance == bake_field(box, options).provenance);
    CHECK(maps.texels == all.texels);
    for (const DisplacementField* field : {&all, &directions, &maps})
        CHECK(payload_hash(read_field(write_field(*field, {.zstd_level = 1}))) == payload_hash(*field));
}

TEST_CASE("plans that cannot be baked are refused with a reason") {
    const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
    const auto refused = [&](const FieldPlan& plan) {
        CHECK(plan_error(plan).size() > 20);
        CHECK_THROWS_AS(bake_plan(box, plan, {}), InputError);
    };
    refused({});
    refused({.maps = kNoMaps, .directions = {{0, 16, 0}}});
    refused({.maps = FieldParameters{Positions::kSlater, 0, Mapping::kConcentric, 8, 8}});
    refused({.lines = LineParameters{1, 0, 0, false, false, false}});
    refused({.directions = {{4, 24, 0}}});
    refused({.directions = {kFine, kCoarse}});
    refused({.directions = {kFine, kFine}});
    refused({.directions = {{128, 128, 128}}});
    FieldPlan many;
    for (std::uint32_t n = 1; n <= kMaxDirectionLevels + 1; ++n) many.directions.push_back({n, 16, 0});
    refused(many);
    many.directions.pop_back();
    CHECK(plan_error(many).empty());
    CHECK(plan_error(default_plan()).empty());
}

TEST_CASE("figures of a verification come into the provenance and out of it") {
    const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
    const std::string plain = provenance_json(box, {kMaps, kLines, {kCoarse}}, {}, "avx");
    const std::string verified = with_verification(plain, "{\"maps\":{\"corner\":{\"rms_grey\":1.5}}}");
    CHECK(verified != plain);
    CHECK(verified.find("\"rms_grey\":1.5") != std::string::npos);
    CHECK(without_verification(verified) == plain);
    CHECK(without_verification(plain) == plain);
    CHECK(without_verification("no JSON") == "no JSON");
    // Whatever is baked differently reads differently.
    for (const FieldPlan& other : {FieldPlan{kMaps, kLines, {kFine}}, FieldPlan{kMaps, kLines, {}},
                                   FieldPlan{kMaps, {}, {kCoarse}}, FieldPlan{{}, kLines, {kCoarse}}})
        CHECK(provenance_json(box, other, {}, "avx") != plain);
}

TEST_CASE("1-bit direction maps of the bunny are small on disk") {
    const auto path = test::shared_file("models/stanford-bunny.obj");
    if (!path) return;
    const TriangleMesh bunny = flatten_scene(import_scene(*path, {}));
    const DisplacementField field = bake_plan(bunny, {.directions = {{16, 64, 0}}}, {});
    const std::size_t bytes = write_field(field).size();
    std::printf("1026 x 64^2 bits of the bunny: %zu bytes on disk, %llu in memory\n", bytes,
                static_cast<unsigned long long>(field.directions[0].memory_bytes()));
    CHECK(bytes < 24 * 1024);
}
