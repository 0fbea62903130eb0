// Blocks of floats, of some of a volume's blocks.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "volume/local.hpp"

namespace dfield::runtime::volume {

// What it holds for a block: kBlock floats, rows of kBlockX. Blocks are named by their tile and their bit in
// it.
class BlockStore {
  public:
    BlockStore(dfield_context* context, std::size_t tiles)
        : context_(context),
          places_(32 * tiles, kNone, context),
          held_(tiles, 0u, context),
          pieces_(context),
          free_(context) {}

    // Neither of these while others read. Of the tile's blocks it holds `blocks` and no others.
    void keep(std::size_t tile, std::uint32_t blocks);
    // It holds these too, whose floats are yet to be written. Without memory it holds some of them.
    void add(std::size_t tile, std::uint32_t blocks);
    // Gives its memory back if it holds nothing.
    void trim();
    float* at(std::size_t tile, std::size_t bit) const {
        const std::uint32_t place = places_[32 * tile + bit];
        return place == kNone
                   ? nullptr
                   : pieces_[place / kPiece] + static_cast<std::ptrdiff_t>(place % kPiece * kBlock);
    }

  private:
    static constexpr std::uint32_t kNone = ~0u;
    static constexpr std::size_t kPiece = 256;  // blocks

    dfield_context* context_;
    std::pmr::vector<std::uint32_t> places_, held_;
    std::pmr::vector<Buffer<float>> pieces_;
    std::pmr::vector<std::uint32_t> free_;
};

}  // namespace dfield::runtime::volume
