// A loaded field: the decoded maps and the positional samples that go with them. Immutable after loading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "context.hpp"
#include "format/field.hpp"
#include "format/file.hpp"

struct dfield_field final : dfield::runtime::Shared<dfield_field> {
    dfield_field(dfield_context* context, std::span<const std::byte> bytes,
                 const dfield::ReadOptions& options = {});

    dfield::DisplacementField maps;
    std::pmr::vector<glm::vec3> points;  // positional samples on the unit sphere, file order
    std::size_t map_stride;              // bytes from one map to the next
    // Of maps of 8 bit: which texels hold a hit, as maps of 1 bit say it, every map from a byte on. Where any
    // hit counts this is all that is read, and it stays in nearer caches.
    std::pmr::vector<std::uint8_t> hit_bits;
    std::size_t hit_stride() const { return (map_stride + 7) / 8; }
    std::pmr::vector<float> self_visibility;
    std::pmr::vector<glm::vec4> line_points;  // the line table's lattice, w = 0; only where it wants a pivot

    std::pmr::vector<float> direction_reach;  // of each level of direction maps: dfield::direction_reach

    // Of each level of direction maps: the share of the lines through the sphere on which it and the finest
    // disagree.
    std::pmr::vector<float> level_disagreement;

    std::uint64_t memory_bytes() const;
};
