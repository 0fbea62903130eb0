// Receivers that stay: whatever is edited, an update ends with what a new set computes, bit for bit.
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "dfield/threads.hpp"
#include "tests/runtime/baked_directions.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

struct Results {
    std::vector<float> visibility, bent, harmonics;
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint32_t> masks;

    Results(std::size_t count, std::size_t words)
        : visibility(count, -1), bent(3 * count), harmonics(9 * count), bytes(count), masks(words * count) {}
    dfield_outputs outputs() {
        dfield_outputs outputs = no_outputs();
        outputs.visibility = visibility.data();
        outputs.visibility8 = bytes.data();
        outputs.bent_normals = bent.data();
        outputs.masks = masks.data();
        outputs.harmonics = harmonics.data();
        return outputs;
    }
    bool operator==(const Results& other) const {
        const auto same = [](const auto& a, const auto& b) {
            return std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
        };
        return same(visibility, other.visibility) && same(bent, other.bent) &&
               same(harmonics, other.harmonics) && bytes == other.bytes && masks == other.masks;
    }
};

TriangleMesh two_boxes() {
    TriangleMesh mesh = box_mesh({-1, -1, -1}, {-0.2f, 1, 0});
    append(mesh, box_mesh({0.3f, -0.5f, -0.2f}, {1, 0.4f, 1}));
    return mesh;
}

// Edits of all sorts, at random.
class Editor {
  public:
    Editor(Scene& scene, std::vector<const Field*> fields, std::uint64_t seed)
        : scene_(scene), fields_(std::move(fields)), random_(seed) {}

    dfield_instance add() {
        const glm::mat4 place = random_placement(random_, {-5, -5, 0}, {5, 5, 2});
        ids_.push_back(scene_.add(field(), &place[0][0]));
        return ids_.back();
    }
    void edit() {
        for (std::uint32_t k = 0; k <= random_.below(3); ++k) {
            const std::uint32_t which = random_.below(16);
            if (which < 2 || ids_.size() < 3) {
                add();
                continue;
            }
            const std::size_t i = random_.below(static_cast<std::uint32_t>(ids_.size()));
            if (which < 4) {
                scene_.remove(ids_[i]);
                ids_.erase(ids_.begin() + static_cast<std::ptrdiff_t>(i));
            } else if (which < 6) {
                scene_.set_hidden(ids_[i], random_.below(2) == 0);
            } else if (which < 8) {
                scene_.set_field(ids_[i], field());
            } else if (which == 8) {
                const float plane[4] = {0, 0.1f, 1, static_cast<float>(random_.uniform(-1, 0))};
                scene_.set_ground(random_.below(2) == 0 ? plane : nullptr);
            } else if (which == 9) {
                continue;  // nothing
            } else {
                const glm::mat4 place = random_placement(random_, {-5, -5, 0}, {5, 5, 2});
                scene_.set_transform(ids_[i], &place[0][0]);
            }
        }
    }

  private:
    const Field& field() { return *fields_[random_.below(static_cast<std::uint32_t>(fields_.size()))]; }

    Scene& scene_;
    std::vector<const Field*> fields_;
    Random random_;
    std::vector<dfield_instance> ids_;
};

ReceiverList some_receivers(Random& random, std::size_t count, std::uint32_t ids) {
    ReceiverList list;
    for (std::size_t i = 0; i < count; ++i) {
        const bool attached = random.below(3) == 0;
        const double reach = attached ? 1.5 : 6;
        list.positions.emplace_back(random.uniform(-reach, reach), random.uniform(-reach, reach),
                                    attached ? random.uniform(-1, 1) : random.uniform(-0.5, 1));
        list.normals.push_back(random.below(2) == 0 ? glm::vec3(0, 0, 1)
                                                    : glm::vec3(random.direction() * 3.0));
        list.attached.push_back(attached ? random.below(ids) : DFIELD_NO_INSTANCE);
        list.owners.push_back(attached && random.below(2) == 0 ? list.attached.back() : DFIELD_NO_INSTANCE);
        list.self.push_back(random.below(2) == 0 ? 1.0f : 0.5f);
    }
    list.positions[1].x = std::numeric_limits<float>::quiet_NaN();
    list.normals[2] = glm::vec3(0);
    return list;
}

void check_edits(const Context& context, const dfield_ao_desc& desc, const std::vector<const Field*>& fields,
                 std::size_t receiver_count, int edits) {
    const Ao ao(context, desc);
    Scene scene(context);
    Editor editor(scene, fields, 7);
    for (int i = 0; i < 30; ++i) editor.add();
    Random random(11);
    const ReceiverList list = some_receivers(random, receiver_count, 6);
    ReceiverSet set(context, ao, list.view(), list.attached.data());
    Results kept(list.size(), ao.mask_words());
    set.outputs(kept.outputs());
    std::size_t partial = 0, changed = 0;
    for (int edit = 0; edit < edits; ++edit) {
        editor.edit();
        const Snapshot snapshot = scene.commit();
        const dfield_update_stats stats = set.update(snapshot);
        partial += stats.computed < list.size();
        changed += stats.changed;
        set.outputs(kept.outputs(), true);

        ReceiverSet fresh(context, ao, list.view(), list.attached.data());
        fresh.update(snapshot);
        Results expected(list.size(), ao.mask_words()), all(list.size(), ao.mask_words());
        fresh.outputs(expected.outputs());
        set.outputs(all.outputs());
        INFO("edit " << edit);
        REQUIRE(all == expected);
        REQUIRE(kept == expected);
        REQUIRE(std::memcmp(set.visibility(), expected.visibility.data(), list.size() * sizeof(float)) == 0);
        REQUIRE(std::memcmp(fresh.visibility(), expected.visibility.data(), list.size() * sizeof(float)) ==
                0);
    }
    // The updates were worth testing.
    CHECK(partial > 0);
    CHECK(changed > 0);
}

dfield_ao_desc shared(std::uint32_t rays) {
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = DFIELD_SAMPLING_SHARED;
    desc.ray_count = rays;
    return desc;
}

}  // namespace

TEST_CASE("An update is a computation from scratch, bit for bit") {
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    std::optional<Threads> threads;
    const std::string way = GENERATE("on one thread", "on two threads", "without SIMD");
    INFO(way);
    if (way == "on two threads") {
        threads.emplace(2);
        threads->install(hooks);
    }
    if (way == "without SIMD") hooks.simd = DFIELD_SIMD_SCALAR;
    const Context context(&hooks);
    const bool scalar = hooks.simd == DFIELD_SIMD_SCALAR;
    const Field box = baked_directions(context, box_mesh({-1, -0.7f, -1}, {1, 0.7f, 1}));
    const Field pair = baked_directions(context, two_boxes(), 8, 32, 16);
    const std::vector<const Field*> fields{&box, &pair};

    // More than one chunk of receivers; two slabs of directions.
    SECTION("shared directions") {
        check_edits(context, shared(96), fields, scalar ? 300 : 3000, scalar ? 12 : 60);
    }
    SECTION("many shared directions") {
        check_edits(context, shared(700), fields, 200, scalar ? 6 : 40);
    }
    SECTION("levels of detail") {
        const auto bytes = baked_directions_bytes(two_boxes(), 8, 32, 16, true);
        const Field levels = Field::load(context, bytes.data(), bytes.size());
        REQUIRE(levels.info().direction_levels == 2);
        dfield_ao_desc desc = shared(96);
        desc.level_error = 0.02f;
        check_edits(context, desc, {&box, &levels}, 300, scalar ? 6 : 30);
    }
    SECTION("shared directions, displacement maps") {
        dfield_ao_desc desc = shared(64);
        desc.kind = DFIELD_KIND_MAPS;
        check_edits(context, desc, fields, 100, 12);
    }
    SECTION("directions around the normal") {
        dfield_ao_desc desc = Ao::defaults();
        desc.ray_count = 64;
        check_edits(context, desc, fields, 100, 12);
    }
    SECTION("falloff") {
        dfield_ao_desc desc = shared(64);
        desc.falloff = DFIELD_FALLOFF_SMOOTH;
        desc.max_distance = 3;
        check_edits(context, desc, fields, 200, 20);
    }
}

TEST_CASE("A set says what queries say") {
    const Context context;
    const Field pair = baked_directions(context, two_boxes(), 8, 32, 16);
    Scene scene(context);
    Random random(5);
    for (int i = 0; i < 8; ++i) {
        const glm::mat4 place = random_placement(random, {-3, -3, 0}, {3, 3, 2});
        scene.add(pair, &place[0][0]);
    }
    ReceiverList list = some_receivers(random, 500, 1);
    list.attached.assign(list.size(), DFIELD_NO_INSTANCE);
    const Snapshot snapshot = scene.commit();
    for (const bool falloff : {false, true}) {
        dfield_ao_desc desc = shared(256);
        if (falloff) desc.falloff = DFIELD_FALLOFF_LINEAR, desc.max_distance = 2;
        const Ao ao(context, desc);
        ReceiverSet set(context, ao, list.view());
        CHECK(set.visibility()[0] == list.self[0]);  // open before the first update
        set.update(snapshot);
        Results expected(list.size(), ao.mask_words()), found(list.size(), ao.mask_words());
        snapshot.ambient(ao, list.view(), expected.outputs());
        set.outputs(found.outputs());
        CHECK(found.masks == expected.masks);
        for (std::size_t i = 0; i < list.size(); ++i) {
            CHECK(set.visibility()[i] == Approx(expected.visibility[i]).margin(2e-6));
            for (std::size_t k = 0; k < 9; ++k)
                CHECK(found.harmonics[9 * i + k] == Approx(expected.harmonics[9 * i + k]).margin(2e-6));
        }
    }
}

TEST_CASE("A small edit looks at some receivers, no edit at none") {
    const Context context;
    const Field box = baked_directions(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    Scene scene(context);
    std::vector<dfield_instance> ids;
    const auto place = [](float x, float y) {
        glm::mat4 m(0.2f);
        m[3] = glm::vec4(x, y, 0.2f, 1);
        return m;
    };
    for (int i = 0; i < 100; ++i) {
        const glm::mat4 m = place(static_cast<float>(i % 10), static_cast<float>(i / 10));
        ids.push_back(scene.add(box, &m[0][0]));
    }
    ReceiverList list;
    for (int i = 0; i < 4000; ++i) {
        list.positions.emplace_back(i % 64 * 0.15f, i / 64 * 0.15f, 0);
        list.normals.emplace_back(0, 0, 1);
    }
    const Ao ao(context, shared(512));
    ReceiverSet set(context, ao, list.view());
    const dfield_update_stats first = set.update(scene.commit());
    CHECK(first.computed == list.size());
    CHECK(first.instances == 100);
    const dfield_update_stats none = set.update(scene.commit());
    CHECK(none.computed == 0);
    CHECK(none.changed == 0);
    CHECK(none.instances == 0);
    const glm::mat4 m = place(4.1f, 5.05f);
    scene.set_transform(ids[54], &m[0][0]);
    const dfield_update_stats moved = set.update(scene.commit());
    CHECK(moved.instances == 1);
    CHECK(moved.changed > 0);
    CHECK(moved.computed < list.size());
    CHECK(moved.changed <= moved.computed);
    std::size_t count = 0;
    dfield_receiver_set_get_changed(set.get(), &count);
    CHECK(count == moved.changed);
}

TEST_CASE("Arguments of receiver sets are checked") {
    const Context context, other;
    const Ao ao(context);
    const float origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    dfield_receiver_set* handle = nullptr;
    dfield_receiver_set_desc desc{};
    desc.ao = ao.get();
    desc.receivers.count = 1;
    desc.receivers.positions = origin;
    desc.receivers.normals = up;
    CHECK(dfield_receiver_set_create(context.get(), &desc, &handle) == DFIELD_INVALID_ARGUMENT);
    CHECK(std::strstr(dfield_error_message(), "struct_size"));
    desc.struct_size = sizeof desc;
    desc.receivers.normals = nullptr;
    CHECK(dfield_receiver_set_create(context.get(), &desc, &handle) == DFIELD_INVALID_ARGUMENT);
    desc.receivers.normals = up;
    desc.ao = nullptr;
    CHECK(dfield_receiver_set_create(context.get(), &desc, &handle) == DFIELD_INVALID_ARGUMENT);
    CHECK(handle == nullptr);
    CHECK(dfield_receiver_set_update(nullptr, nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_receiver_set_get_visibility(nullptr) == nullptr);
    Scene foreign(other);
    dfield_receivers receivers = desc.receivers;
    ReceiverSet set(context, ao, receivers);
    CHECK(dfield_receiver_set_update(set.get(), foreign.commit().get(), nullptr) == DFIELD_INVALID_ARGUMENT);
    Results results(1, ao.mask_words());
    dfield_outputs outputs = results.outputs();
    outputs.struct_size = 3;
    CHECK(dfield_receiver_set_get_outputs(set.get(), &outputs, 0) == DFIELD_INVALID_ARGUMENT);
    receivers.count = 0;
    ReceiverSet empty(context, ao, receivers);
    Scene scene(context);
    CHECK(empty.update(scene.commit()).computed == 0);
}
