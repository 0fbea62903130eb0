// Loading through the C ABI: parts of files, kinds, the log.
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "dfield/dfield.hpp"
#include "tests/format/kinds.hpp"
#include "tests/runtime/baked_directions.hpp"
#include "tests/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

Field golden(const Context& context, const char* name) {
    return Field::load(context,
                       source_file(std::string("tests/golden/") + name + ".dfield").string().c_str());
}

constexpr std::uint32_t bit(dfield_kind kind) {
    return 1u << kind;
}

}  // namespace

TEST_CASE("A field says which kinds it holds, settings which one they use") {
    const Context context;
    const Field all = golden(context, "v1.1-all-kinds"), maps = golden(context, "v1.0-8bit"),
                lines = golden(context, "v1.1-lines"), directions = golden(context, "v1.1-directions");
    CHECK(all.info().kinds == (bit(DFIELD_KIND_MAPS) | bit(DFIELD_KIND_LINES) | bit(DFIELD_KIND_DIRECTIONS)));
    CHECK(maps.info().kinds == bit(DFIELD_KIND_MAPS));
    CHECK(lines.info().kinds == bit(DFIELD_KIND_LINES));
    CHECK(lines.info().line_lattice > 0);
    CHECK(lines.info().bits == 0);
    CHECK(directions.info().kinds == bit(DFIELD_KIND_DIRECTIONS));
    CHECK(directions.info().direction_count > 0);
    CHECK(directions.info().direction_levels > 0);

    dfield_ao_desc desc = Ao::defaults();
    const Ao around(context, desc);
    desc.sampling = DFIELD_SAMPLING_SHARED;
    const Ao shared(context, desc);
    desc.kind = DFIELD_KIND_MAPS;
    const Ao forced(context, desc);
    CHECK(around.kind(maps) == DFIELD_KIND_MAPS);
    CHECK(around.kind(all) == DFIELD_KIND_LINES);
    CHECK(shared.kind(all) == DFIELD_KIND_DIRECTIONS);
    CHECK(shared.kind(maps) == DFIELD_KIND_MAPS);
    CHECK(forced.kind(all) == DFIELD_KIND_MAPS);
    dfield_kind kind = DFIELD_KIND_AUTO;
    CHECK(dfield_ao_get_kind(around.get(), directions.get(), &kind) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_ao_get_kind(forced.get(), lines.get(), &kind) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_ao_get_kind(nullptr, nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(kind == DFIELD_KIND_AUTO);

    // Queries say so too.
    Scene scene(context);
    scene.add(directions, kIdentity);
    const float origin[3] = {0, 0, -9}, up[3] = {0, 0, 1};
    dfield_receivers receivers{};
    receivers.count = 1, receivers.positions = origin, receivers.normals = up;
    float visibility = 7;
    CHECK(dfield_scene_visibility(scene.get(), around.get(), &receivers, &visibility, 0) ==
          DFIELD_INVALID_ARGUMENT);
    CHECK(visibility == 7);
    CHECK(dfield_scene_visibility(scene.get(), shared.get(), &receivers, &visibility, 0) == DFIELD_OK);
    CHECK(visibility < 1);
}

TEST_CASE("A part of a file is loaded") {
    const Context context;
    const auto bytes = baked_directions_bytes(box_mesh({-1, -1, -1}, {1, 1, 1}));
    const auto load = [&](std::uint32_t kinds) {
        return Field::load(context, bytes.data(), bytes.size(), kinds);
    };
    const std::uint64_t all = load(0).info().memory_bytes;
    const Field maps = load(bit(DFIELD_KIND_MAPS)), directions = load(bit(DFIELD_KIND_DIRECTIONS));
    CHECK(maps.info().kinds == bit(DFIELD_KIND_MAPS));
    CHECK(directions.info().kinds == bit(DFIELD_KIND_DIRECTIONS));
    CHECK(maps.info().memory_bytes < all);
    CHECK(directions.info().memory_bytes < all);
    CHECK(directions.info().radius == maps.info().radius);

    const Field everything = golden(context, "v1.2-all-kinds");
    CHECK(everything.info().kinds == (bit(DFIELD_KIND_MAPS) | bit(DFIELD_KIND_LINES) |
                                      bit(DFIELD_KIND_DIRECTIONS) | bit(DFIELD_KIND_VOLUME)));
    const auto whole = write_field(make_all_kinds_and_volume());
    const Field volume = Field::load(context, whole.data(), whole.size(), bit(DFIELD_KIND_VOLUME));
    CHECK(volume.info().kinds == bit(DFIELD_KIND_VOLUME));
    CHECK(volume.info().volume_dims[2] == 6);
    CHECK(volume.info().memory_bytes < everything.info().memory_bytes);

    dfield_load_desc desc{};
    dfield_field* field = nullptr;
    CHECK(dfield_field_load_part(context.get(), &desc, bytes.data(), bytes.size(), &field) ==
          DFIELD_INVALID_ARGUMENT);
    CHECK(std::strstr(dfield_error_message(), "struct_size"));
    desc.struct_size = sizeof desc;
    desc.kinds = bit(DFIELD_KIND_LINES);
    CHECK(dfield_field_load_part(context.get(), &desc, bytes.data(), bytes.size(), &field) ==
          DFIELD_INVALID_ARGUMENT);
    CHECK(std::strstr(dfield_error_message(), "none of the wanted kinds"));
    CHECK(dfield_field_load_part(context.get(), &desc, bytes.data(), 40, &field) == DFIELD_FORMAT_ERROR);
    CHECK(dfield_field_load_part(nullptr, nullptr, nullptr, 0, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(field == nullptr);
}

TEST_CASE("The log hears of contexts, fields and caps that the machine lacks") {
    std::vector<std::pair<int, std::string>> lines;
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    hooks.user = &lines;
    hooks.log = [](void* user, int level, const char* message) {
        static_cast<std::vector<std::pair<int, std::string>>*>(user)->emplace_back(level, message);
    };
    hooks.simd = DFIELD_SIMD_SCALAR;
    const Context context(&hooks);
    CHECK(context.simd() == DFIELD_SIMD_SCALAR);
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].first == DFIELD_LOG_INFO);
    CHECK(lines[0].second.find("scalar") != std::string::npos);
    const Field field = golden(context, "v1.1-all-kinds");
    REQUIRE(lines.size() == 2);
    CHECK(lines[1].second.find("line table") != std::string::npos);

    // Queries say nothing.
    Scene scene(context);
    scene.add(field, kIdentity);
    const Ao ao(context);
    const float origin[3] = {0, 0, -9}, up[3] = {0, 0, 1};
    dfield_receivers receivers{};
    receivers.count = 1, receivers.positions = origin, receivers.normals = up;
    float visibility = 7;
    scene.visibility(ao, receivers, &visibility);
    CHECK(lines.size() == 2);

    // No machine has both.
    std::size_t warnings = 0;
    for (const std::uint32_t simd : {DFIELD_SIMD_SSE4, DFIELD_SIMD_NEON}) {
        lines.clear();
        hooks.simd = simd;
        const Context capped(&hooks);
        for (const auto& [level, text] : lines) warnings += level == DFIELD_LOG_WARNING;
    }
    CHECK(warnings >= 1);
    hooks.simd = 6;
    dfield_context* refused = nullptr;
    CHECK(dfield_context_create(&hooks, &refused) == DFIELD_INVALID_ARGUMENT);
}
