// Reading glTF accessors: any component type, normalised or not, interleaved, sparse, every byte within its
// buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/gltf_document.hpp"

namespace dfield {

// The accessor's elements as numbers, `components` for each, one after the other; normalised integers become
// -1..1 or 0..1. `what` names its use in messages ("POSITION of mesh 3"). Throws InputError: no such
// accessor, another number of components, sizes beyond the buffer view or buffer, sparse indices out of order
// or range, more than 2^31 elements, or more than 2^24 that no buffer backs.
std::vector<float> read_accessor(const GltfDocument& document, int accessor, int components,
                                 const std::string& what);

// SCALAR of unsigned byte, short or int.
std::vector<std::uint32_t> read_index_accessor(const GltfDocument& document, int accessor,
                                               const std::string& what);

// Numbers an element has, for an accessor that exists (InputError otherwise).
int accessor_components(const GltfDocument& document, int accessor, const std::string& what);

// Its element count, for an accessor that exists (InputError otherwise).
std::size_t accessor_count(const GltfDocument& document, int accessor, const std::string& what);

}  // namespace dfield
