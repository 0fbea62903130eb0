#include "volume/block_store.hpp"

#include <bit>

namespace dfield::runtime::volume {

void BlockStore::keep(std::size_t tile, std::uint32_t blocks) {
    for (std::uint32_t gone = held_[tile] & ~blocks; gone != 0; gone &= gone - 1) {
        std::uint32_t& place = places_[32 * tile + static_cast<std::size_t>(std::countr_zero(gone))];
        free_.push_back(place);  // there is room: each place was in it once
        place = kNone;
    }
    held_[tile] &= blocks;
}

void BlockStore::add(std::size_t tile, std::uint32_t blocks) {
    for (std::uint32_t more = blocks & ~held_[tile]; more != 0; more &= more - 1) {
        if (free_.empty()) {
            const std::size_t places = (pieces_.size() + 1) * kPiece;
            if (free_.capacity() < places) free_.reserve(places + places / 2);
            pieces_.emplace_back(context_, kPiece * kBlock);
            for (std::size_t i = kPiece; i-- > 0;)
                free_.push_back(static_cast<std::uint32_t>((pieces_.size() - 1) * kPiece + i));
        }
        places_[32 * tile + static_cast<std::size_t>(std::countr_zero(more))] = free_.back();
        free_.pop_back();
        held_[tile] |= more & (0u - more);
    }
}

void BlockStore::trim() {
    if (free_.size() < pieces_.size() * kPiece) return;
    pieces_.clear();
    free_.clear();
}

}  // namespace dfield::runtime::volume
