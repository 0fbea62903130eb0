// Fields with an occlusion volume alone, baked for a test.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "baker/plan.hpp"
#include "dfield/dfield.hpp"
#include "format/writer.hpp"
#include "tests/runtime/placements.hpp"

namespace dfield::test {

inline std::vector<std::byte> baked_volume_bytes(const TriangleMesh& mesh, std::uint32_t size = 32) {
    FieldPlan plan;
    plan.volume = VolumeParameters{size};
    return write_field(bake_plan(mesh, plan, {}), {.zstd_level = 1});
}

inline Field baked_volume(const Context& context, const TriangleMesh& mesh, std::uint32_t size = 32) {
    const auto bytes = baked_volume_bytes(mesh, size);
    return Field::load(context, bytes.data(), bytes.size());
}

// What receivers see past one instance.
inline std::vector<float> visibility_past(const Context& context, const Field& field,
                                          const glm::mat4& transform, const ReceiverList& receivers) {
    Scene scene(context);
    scene.add(field, &transform[0][0]);
    std::vector<float> visibility(receivers.size(), -1);
    scene.visibility(Ao(context), receivers.view(), visibility.data());
    return visibility;
}

}  // namespace dfield::test
