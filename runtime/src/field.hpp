// A loaded field: the decoded maps and the positional samples that go with them. Immutable after loading.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

#include "context.hpp"
#include "format/field.hpp"

struct dfield_field final : dfield::runtime::Shared<dfield_field> {
    dfield_field(dfield_context* context, std::span<const std::byte> bytes);

    dfield::DisplacementField maps;
    std::pmr::vector<glm::vec3> points;  // positional samples on the unit sphere, file order
    std::size_t map_stride;              // bytes from one map to the next
    std::pmr::vector<float> self_visibility;

    std::uint64_t memory_bytes() const;
};
