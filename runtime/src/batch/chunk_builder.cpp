#include "batch/chunk_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "batch/loaded.hpp"
#include "receivers.hpp"

namespace dfield::runtime {
namespace {

static_assert(kMostLoaded == kChunkBlocks * kLanes);

// Cells of a side in the order of a Hilbert curve, whose neighbours all touch: a block's box stays small,
// where the Morton order of the cells' own numbers jumps.
constexpr std::array<std::uint8_t, 1 << 2 * kCellBits> hilbert_order() {
    std::array<std::uint8_t, 1 << 2 * kCellBits> order{};
    for (std::uint32_t at = 0; at < order.size(); ++at) {
        std::uint32_t x = 0, y = 0, rest = at;
        for (std::uint32_t side = 1; side < 1u << kCellBits; side *= 2, rest /= 4) {
            const std::uint32_t right = rest / 2 & 1, up = (rest ^ right) & 1;
            if (!up) {  // turned, and mirrored in the last quarter
                if (right) x = side - 1 - x, y = side - 1 - y;
                const std::uint32_t swap = x;
                x = y;
                y = swap;
            }
            x += side * right;
            y += side * up;
        }
        order[at] = static_cast<std::uint8_t>(spread(x) << 1 | spread(y));
    }
    return order;
}
constexpr auto kHilbert = hilbert_order();

bool packed(std::size_t stride) {
    return stride == 0 || stride == 3 * sizeof(float);
}

}  // namespace

void load_receivers(const dfield_receivers& receivers, std::size_t begin, Loaded& loaded) {
    const ReceiverReader reader(receivers);
    for (std::size_t i = 0; i < loaded.count; ++i) {
        const UnitReceiver receiver = reader[begin + i];
        loaded.x[i] = receiver.position.x;
        loaded.y[i] = receiver.position.y;
        loaded.z[i] = receiver.position.z;
        loaded.nx[i] = receiver.normal.x;
        loaded.ny[i] = receiver.normal.y;
        loaded.nz[i] = receiver.normal.z;
        if (!receiver.usable()) continue;
        loaded.low = glm::min(loaded.low, receiver.position);
        loaded.high = glm::max(loaded.high, receiver.position);
    }
}

void build_chunk(const BatchKernels& kernels, const dfield_receivers& receivers, std::size_t begin,
                 std::size_t end, Chunk& chunk, LaneOfReceiver& lane_of) {
    Loaded loaded;
    const std::size_t count = loaded.count = end - begin;
    if (packed(receivers.position_stride) && packed(receivers.normal_stride))
        kernels.load_packed(receivers.positions + 3 * begin, receivers.normals + 3 * begin, loaded);
    else
        load_receivers(receivers, begin, loaded);
    kernels.find_cells(loaded);

    std::array<std::uint16_t, kCells + 1> starts{};
    for (std::size_t i = 0; i < count; ++i) ++starts[loaded.cells[i]];
    // The sum in a register: through the array each step would wait for the one before to be stored.
    std::uint16_t usable = 0;
    for (std::size_t side = 0; side < kCells; side += kHilbert.size())
        for (const std::uint8_t cell : kHilbert) {
            const std::uint16_t here = starts[side + cell];
            starts[side + cell] = usable;
            usable += here;
        }
    chunk.blocks = (usable + kLanes - 1) / kLanes;
    chunk.any_owner = receivers.owners != nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        if (loaded.cells[i] == kNoCell) {
            lane_of[i] = kLeftOut;
            continue;
        }
        const std::uint16_t lane = starts[loaded.cells[i]]++;
        lane_of[i] = lane;
        chunk.x[lane] = loaded.x[i];
        chunk.y[lane] = loaded.y[i];
        chunk.z[lane] = loaded.z[i];
        chunk.nx[lane] = loaded.nx[i];
        chunk.ny[lane] = loaded.ny[i];
        chunk.nz[lane] = loaded.nz[i];
    }
    std::fill_n(chunk.owners.begin(), chunk.blocks * kLanes, DFIELD_NO_INSTANCE);
    if (const Strided<const dfield_instance> owners(receivers.owners, receivers.owner_stride, 1); owners)
        for (std::size_t i = 0; i < count; ++i)
            if (lane_of[i] != kLeftOut) chunk.owners[lane_of[i]] = *owners.at(begin + i);
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        const std::size_t lanes = std::min(kLanes, usable - b * kLanes);
        chunk.lanes[b] = static_cast<std::uint16_t>((1u << lanes) - 1);
    }
    for (std::size_t lane = usable; lane < chunk.blocks * kLanes; ++lane)
        for (auto* axis : {&chunk.x, &chunk.y, &chunk.z, &chunk.nx, &chunk.ny, &chunk.nz})
            (*axis)[lane] = (*axis)[usable - 1];
    finish_chunk(kernels, chunk);
}

void finish_chunk(const BatchKernels& kernels, Chunk& chunk) {
    chunk.low = glm::vec3(INFINITY);
    chunk.high = glm::vec3(-INFINITY);
    std::array<glm::vec3, kChunkBlocks / 16> group_low, group_high;
    group_low.fill(chunk.low);
    group_high.fill(chunk.high);
    chunk.irregular.fill(0);
    chunk.flat.fill(0);
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        const auto [low, high, axis, cosine] = kernels.bound_block(chunk, b);
        if (cosine == 1) chunk.flat[b / 16] |= static_cast<std::uint16_t>(1u << b % 16);
        const auto owners = chunk.owners.begin() + static_cast<std::ptrdiff_t>(b * kLanes);
        if (chunk.lanes[b] != 0xffff ||
            (chunk.any_owner && std::any_of(owners, owners + kLanes,
                                            [](dfield_instance id) { return id != DFIELD_NO_INSTANCE; })))
            chunk.irregular[b / 16] |= static_cast<std::uint16_t>(1u << b % 16);
        // Boxes are enough larger than their receivers for what rounding does to texel coordinates.
        const glm::vec3 farthest = glm::max(glm::abs(low), glm::abs(high));
        const float slack = 1e-6f * std::max({farthest.x, farthest.y, farthest.z});
        const glm::vec3 centre = 0.5f * (low + high), half = 0.5f * (high - low) + slack;
        chunk.centre_x[b] = centre.x;
        chunk.centre_y[b] = centre.y;
        chunk.centre_z[b] = centre.z;
        chunk.half_x[b] = half.x;
        chunk.half_y[b] = half.y;
        chunk.half_z[b] = half.z;
        group_low[b / 16] = glm::min(group_low[b / 16], centre - half);
        group_high[b / 16] = glm::max(group_high[b / 16], centre + half);
        chunk.axis_x[b] = axis.x;
        chunk.axis_y[b] = axis.y;
        chunk.axis_z[b] = axis.z;
        // A direction faces some normal of a cone if its cosine with the axis is above -sine; cones of more
        // than a hemisphere face everything.
        chunk.sine[b] = cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) + 1e-5f : 2.0f;
    }
    for (std::size_t g = 0; g < chunk.groups(); ++g) {
        const glm::vec3 half = 0.5f * (group_high[g] - group_low[g]);
        chunk.group_boxes[g] = {group_low[g] + half, half, glm::length(half)};
        chunk.low = glm::min(chunk.low, group_low[g]);
        chunk.high = glm::max(chunk.high, group_high[g]);
    }
    for (std::size_t b = chunk.blocks; b < std::min(kChunkBlocks, (chunk.blocks + 15) / 16 * 16); ++b) {
        chunk.centre_x[b] = chunk.centre_y[b] = chunk.centre_z[b] = 0;
        chunk.half_x[b] = chunk.half_y[b] = chunk.half_z[b] = 0;
        chunk.axis_x[b] = chunk.axis_y[b] = chunk.axis_z[b] = 0;
        chunk.sine[b] = -2;  // faces nothing
        chunk.lanes[b] = 0;
    }
}

}  // namespace dfield::runtime
