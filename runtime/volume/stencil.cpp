#include "volume/stencil.hpp"

#include <algorithm>
#include <tuple>

#include "volume/local.hpp"

namespace dfield::runtime::volume {
namespace {

constexpr std::ptrdiff_t kBricks = kBlockX / kBrickX;  // a block, along x
static_assert(kBrickY == kBlockY && kBrickZ == kBlockZ);
constexpr std::ptrdiff_t kWord = 64;

constexpr std::ptrdiff_t signed_of(std::size_t n) {
    return static_cast<std::ptrdiff_t>(n);
}

// Windows that have a flag, a bit each, in words of 64 blocks: bit i of phase p is the window that begins
// with brick kBricks (i - before) + p of its row. Words one after the other along y, [low, high).
class WindowBits {
  public:
    // Of bricks [first, end). before, after: how many blocks more than the grid's a shift may ask for.
    WindowBits(dfield_context* context, const BrickFlags& flags, std::uint8_t bit,
               const std::size_t (&first)[3], const std::size_t (&end)[3], std::ptrdiff_t blocks,
               std::ptrdiff_t before, std::ptrdiff_t after)
        // Windows reach over 5 x 2 x 2 bricks.
        : low{signed_of(first[1]) - 1, signed_of(first[2]) - 1},
          high{signed_of(end[1]), signed_of(end[2])},
          before_(before),
          words_((blocks + kWord - 1) / kWord + (before + after) / kWord + 2),
          bits_(static_cast<std::size_t>((high[1] - low[1]) * kBricks * words_ * rows()), context) {
        context->for_ranges(
            static_cast<std::size_t>(high[1] - low[1]), [&](std::size_t from, std::size_t to) {
                for (std::ptrdiff_t z = low[1] + signed_of(from); z < low[1] + signed_of(to); ++z)
                    for (std::ptrdiff_t y = low[0]; y < high[0]; ++y) {
                        const std::uint8_t* const row = flags.window_at(0, y, z);
                        for (std::ptrdiff_t x = signed_of(first[0]) - 4; x < signed_of(end[0]); ++x)
                            if (row[x] & bit) {
                                const std::ptrdiff_t i = x + kBricks * before_, block = i / kBricks;
                                bits_[index(i % kBricks, block / kWord, y, z)] |= std::uint64_t{1}
                                                                                  << block % kWord;
                            }
                    }
            });
    }

    const std::ptrdiff_t low[2], high[2];  // y, z

    std::ptrdiff_t rows() const { return high[0] - low[0]; }
    // For blocks [64 word, 64 word + count) of `count` rows from y on: adds the bits of the windows that are
    // `along` blocks and `phase` bricks from theirs to `met`.
    void add(std::ptrdiff_t phase, std::ptrdiff_t along, std::ptrdiff_t word, std::ptrdiff_t blocks,
             std::ptrdiff_t y, std::ptrdiff_t z, std::ptrdiff_t count, std::uint64_t* met) const {
        const std::ptrdiff_t shift = (before_ + along) % kWord;
        const std::uint64_t *const here = &bits_[index(phase, word + (before_ + along) / kWord, y, z)],
                                   *const next = here + rows();
        if (shift + blocks <= kWord)
            for (std::ptrdiff_t i = 0; i < count; ++i) met[i] |= here[i] >> shift;
        else
            for (std::ptrdiff_t i = 0; i < count; ++i)
                met[i] |= here[i] >> shift | next[i] << (kWord - shift);
    }

  private:
    std::size_t index(std::ptrdiff_t phase, std::ptrdiff_t word, std::ptrdiff_t y, std::ptrdiff_t z) const {
        return static_cast<std::size_t>((((z - low[1]) * kBricks + phase) * words_ + word) * rows() + y -
                                        low[0]);
    }

    const std::ptrdiff_t before_, words_;
    std::pmr::vector<std::uint64_t> bits_;
};

// Blocks of a row from block x on, a bit each, into their tiles' words.
void add_to_tiles(const Grid& grid, std::uint64_t row, std::size_t x, std::size_t y, std::size_t z,
                  std::pmr::vector<std::uint32_t>& blocks) {
    const auto tiles = tiles_of(grid);
    std::uint32_t* const first =
        &blocks[x / kTileBlocksX + tiles[0] * (y / kTileBlocksY + tiles[1] * (z / kTileBlocksZ))];
    constexpr std::uint64_t kMask = (1u << kTileBlocksX) - 1;
    for (std::size_t tile = 0; row != 0; ++tile, row >>= kTileBlocksX)
        first[tile] |= static_cast<std::uint32_t>(row & kMask)
                       << block_bit(0, y % kTileBlocksY, z % kTileBlocksZ);
}

}  // namespace

Stencil::Stencil(std::pmr::memory_resource* memory, const BrickFlags& flags, std::span<const Offset> offsets)
    : steps_(memory) {
    steps_.reserve(offsets.size());
    for (const Offset& offset : offsets) {
        const Offset at = flags.window_step(offset);
        const auto bricks = static_cast<std::int32_t>(kBricks), phase = (at[0] % bricks + bricks) % bricks;
        steps_.push_back({at[2], phase, (at[0] - phase) / bricks, at[1]});
    }
    const auto key = [](const Step& s) { return std::tie(s.z, s.phase, s.along, s.y); };
    std::ranges::sort(steps_, {}, key);
    const auto same = [&](const Step& a, const Step& b) { return key(a) == key(b); };
    steps_.erase(std::unique(steps_.begin(), steps_.end(), same), steps_.end());
    for (const Step& s : steps_) {
        const Offset step{s.along, s.y, s.z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low_[axis] = std::min(low_[axis], step[axis]);
            high_[axis] = std::max(high_[axis], step[axis]);
        }
    }
}

void Stencil::mark(dfield_context* context, const Grid& grid, const BrickFlags& flags, std::uint8_t bit,
                   std::pmr::vector<std::uint32_t>& blocks) const {
    std::size_t first[3], end[3];
    if (steps_.empty() || !flags.bounds(bit, first, end)) return;
    const std::ptrdiff_t nx = signed_of((grid.nx + kBlockX - 1) / kBlockX),
                         ny = signed_of((grid.ny + kBlockY - 1) / kBlockY),
                         nz = signed_of((grid.nz + kBlockZ - 1) / kBlockZ);
    const WindowBits windows(context, flags, bit, first, end, nx, std::max(1, -low_[0]), high_[0]);
    // Blocks that look so far; in layers of tiles, so that no two threads share a tile.
    const std::ptrdiff_t begin_y = std::max(std::ptrdiff_t{0}, windows.low[0] - high_[1]),
                         end_y = std::min(ny, windows.high[0] - low_[1]),
                         begin_z = std::max(std::ptrdiff_t{0}, windows.low[1] - high_[2]),
                         end_z = std::min(nz, windows.high[1] - low_[2]);
    if (begin_y >= end_y || begin_z >= end_z) return;
    constexpr std::ptrdiff_t kLayer = kTileBlocksZ;
    const std::ptrdiff_t first_layer = begin_z / kLayer, layers = (end_z - 1) / kLayer + 1 - first_layer,
                         rows = end_y - begin_y;
    std::pmr::vector<std::uint64_t> met_rows(static_cast<std::size_t>(layers * rows), context);
    const auto mark_slice = [&](std::ptrdiff_t z, std::ptrdiff_t word, std::uint64_t* met) {
        const std::ptrdiff_t count = std::min(kWord, nx - word * kWord);
        std::fill_n(met, rows, std::uint64_t{0});
        for (const Step& step : steps_) {
            if (z + step.z < windows.low[1] || z + step.z >= windows.high[1]) continue;
            const std::ptrdiff_t from = std::max(begin_y, windows.low[0] - step.y),
                                 to = std::min(end_y, windows.high[0] - step.y);
            if (from < to)
                windows.add(step.phase, step.along, word, count, from + step.y, z + step.z, to - from,
                            met + (from - begin_y));
        }
        // Bits beyond the grid are of other windows, or of none.
        const std::uint64_t inside = ~std::uint64_t{0} >> (kWord - count);
        for (std::ptrdiff_t y = 0; y < rows; ++y)
            add_to_tiles(grid, met[y] & inside, static_cast<std::size_t>(word * kWord),
                         static_cast<std::size_t>(begin_y + y), static_cast<std::size_t>(z), blocks);
    };
    context->for_ranges(static_cast<std::size_t>(layers), [&](std::size_t from, std::size_t to) {
        for (std::ptrdiff_t layer = signed_of(from); layer < signed_of(to); ++layer)
            for (std::ptrdiff_t i = 0; i < kLayer; ++i) {
                const std::ptrdiff_t z = (first_layer + layer) * kLayer + i;
                for (std::ptrdiff_t word = 0; word * kWord < nx && z >= begin_z && z < end_z; ++word)
                    mark_slice(z, word, &met_rows[static_cast<std::size_t>(layer * rows)]);
            }
    });
}

}  // namespace dfield::runtime::volume
