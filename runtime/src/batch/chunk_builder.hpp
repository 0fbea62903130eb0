// Receivers sorted into the blocks of a chunk, so that a block's receivers lie and face alike.
#pragma once

#include <array>

#include "batch/chunk.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// Fills the chunk with receivers [begin, end), at most kChunkBlocks * kLanes; those with an unusable position
// or normal are left out. lane_of[i - begin] says where receiver i went: block * kLanes + lane, or kLeftOut.
inline constexpr std::uint16_t kLeftOut = 0xffff;
using LaneOfReceiver = std::array<std::uint16_t, kChunkBlocks * kLanes>;
void build_chunk(const BatchKernels& kernels, const dfield_receivers& receivers, std::size_t begin,
                 std::size_t end, Chunk& chunk, LaneOfReceiver& lane_of);

// Boxes and normal cones of the blocks, from their lanes; lanes without a receiver repeat one that is.
void finish_chunk(const BatchKernels& kernels, Chunk& chunk);

}  // namespace dfield::runtime
