#include "batch/chunk_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "receivers.hpp"

namespace dfield::runtime {
namespace {

constexpr std::size_t kReceivers = kChunkBlocks * kLanes;
constexpr int kCellBits = 4;                         // of each of two axes
constexpr std::size_t kCells = 6u << 2 * kCellBits;  // for each axis that normals point along, either way

// Bits 0 to 3 to places 0, 2, 4, 6.
constexpr std::uint32_t spread(std::uint32_t v) {
    v = (v | v << 2) & 0x33;
    return (v | v << 1) & 0x55;
}

// Receivers as they come, one array an axis, so that compilers make vectors of the loops over them.
struct Loaded {
    std::array<float, kReceivers> x, y, z, nx, ny, nz;
    std::array<dfield_instance, kReceivers> owners;
    glm::vec3 low{INFINITY}, high{-INFINITY};
};

void load(const dfield_receivers& receivers, std::size_t begin, std::size_t count, Loaded& loaded) {
    const ReceiverReader reader(receivers);
    for (std::size_t i = 0; i < count; ++i) {
        const UnitReceiver receiver = reader[begin + i];
        loaded.x[i] = receiver.position.x;
        loaded.y[i] = receiver.position.y;
        loaded.z[i] = receiver.position.z;
        loaded.nx[i] = receiver.normal.x;
        loaded.ny[i] = receiver.normal.y;
        loaded.nz[i] = receiver.normal.z;
        loaded.owners[i] = receiver.owner;
        if (!receiver.usable()) continue;
        loaded.low = glm::min(loaded.low, receiver.position);
        loaded.high = glm::max(loaded.high, receiver.position);
    }
}

constexpr std::uint16_t kNoCell = kCells;

// Where a receiver goes: first by the axis that is nearest to its normal, then along a Morton curve across that
// axis. Surfaces that face alike and lie behind each other are rare among neighbours.
void find_cells(const Loaded& loaded, std::size_t count, std::array<std::uint16_t, kReceivers>& cells) {
    // Cells are squares, so that narrow sets of receivers use all bits on their long side.
    const glm::vec3 size = loaded.high - loaded.low;
    const float side = std::max({size.x, size.y, size.z});
    const float scale = side > 0 ? 0.9999f * (1 << kCellBits) / side : 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = [&](float value, float low) {  // unusable receivers may hold NaN
            return spread(static_cast<std::uint32_t>(std::min(15.0f, std::max(0.0f, (value - low) * scale))));
        };
        const std::uint32_t x = place(loaded.x[i], loaded.low.x), y = place(loaded.y[i], loaded.low.y),
                            z = place(loaded.z[i], loaded.low.z);
        const float ax = std::fabs(loaded.nx[i]), ay = std::fabs(loaded.ny[i]), az = std::fabs(loaded.nz[i]);
        const std::uint32_t along_x = (loaded.nx[i] < 0) << 2 * kCellBits | y << 1 | z;
        const std::uint32_t along_y = (2 + (loaded.ny[i] < 0)) << 2 * kCellBits | z << 1 | x;
        const std::uint32_t along_z = (4 + (loaded.nz[i] < 0)) << 2 * kCellBits | x << 1 | y;
        const std::uint32_t cell = ax >= std::max(ay, az) ? along_x : ay >= az ? along_y : along_z;
        cells[i] = static_cast<std::uint16_t>(ax + ay + az > 0 ? cell : kNoCell);
    }
}

}  // namespace

void build_chunk(const dfield_receivers& receivers, std::size_t begin, std::size_t end, Chunk& chunk,
                 LaneOfReceiver& lane_of) {
    const std::size_t count = end - begin;
    Loaded loaded;
    load(receivers, begin, count, loaded);
    std::array<std::uint16_t, kReceivers> cells;
    find_cells(loaded, count, cells);

    std::array<std::uint16_t, kCells + 2> starts{};
    for (std::size_t i = 0; i < count; ++i) ++starts[cells[i] + 1u];
    for (std::size_t cell = 0; cell < kCells; ++cell) starts[cell + 1] += starts[cell];
    const std::size_t usable = starts[kCells];
    chunk.blocks = (usable + kLanes - 1) / kLanes;
    chunk.any_owner = receivers.owners != nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        if (cells[i] == kNoCell) {
            lane_of[i] = kLeftOut;
            continue;
        }
        const std::uint16_t lane = starts[cells[i]]++;
        lane_of[i] = lane;
        chunk.x[lane] = loaded.x[i];
        chunk.y[lane] = loaded.y[i];
        chunk.z[lane] = loaded.z[i];
        chunk.nx[lane] = loaded.nx[i];
        chunk.ny[lane] = loaded.ny[i];
        chunk.nz[lane] = loaded.nz[i];
        chunk.owners[lane] = loaded.owners[i];
    }
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        const std::size_t lanes = std::min(kLanes, usable - b * kLanes);
        chunk.lanes[b] = static_cast<std::uint16_t>((1u << lanes) - 1);
    }
    for (std::size_t lane = usable; lane < chunk.blocks * kLanes; ++lane) {
        for (auto* axis : {&chunk.x, &chunk.y, &chunk.z, &chunk.nx, &chunk.ny, &chunk.nz})
            (*axis)[lane] = (*axis)[usable - 1];
        chunk.owners[lane] = DFIELD_NO_INSTANCE;
    }
    finish_chunk(chunk);
}

void finish_chunk(Chunk& chunk) {
    chunk.low = glm::vec3(INFINITY);
    chunk.high = glm::vec3(-INFINITY);
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        glm::vec3 low(INFINITY), high(-INFINITY), axis(0);
        for (std::size_t i = b * kLanes; i < (b + 1) * kLanes; ++i) {
            const glm::vec3 p(chunk.x[i], chunk.y[i], chunk.z[i]);
            low = glm::min(low, p);
            high = glm::max(high, p);
            axis += glm::vec3(chunk.nx[i], chunk.ny[i], chunk.nz[i]);
        }
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
        chunk.low = glm::min(chunk.low, centre - half);
        chunk.high = glm::max(chunk.high, centre + half);
        const float length = glm::length(axis);
        float cosine = -1;
        if (length > 0) {
            axis /= length;
            cosine = 1;
            for (std::size_t i = b * kLanes; i < (b + 1) * kLanes; ++i)
                cosine = std::min(cosine, axis.x * chunk.nx[i] + axis.y * chunk.ny[i] + axis.z * chunk.nz[i]);
        }
        chunk.axis_x[b] = axis.x;
        chunk.axis_y[b] = axis.y;
        chunk.axis_z[b] = axis.z;
        // A direction faces some normal of a cone if its cosine with the axis is above -sine; cones of more than a
        // hemisphere face everything.
        chunk.sine[b] = cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) + 1e-5f : 2.0f;
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
