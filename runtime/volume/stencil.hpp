// Which windows of bricks a block's rays look into, as words to be tested at once.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <span>
#include <vector>

#include "volume/opacity.hpp"

namespace dfield::runtime::volume {

class Stencil {
  public:
    Stencil(std::pmr::memory_resource* memory, const BrickFlags& flags, std::span<const Offset> offsets);

    // Whether any of them has this bit, seen from a block's own window.
    bool meets(const std::uint8_t* window, std::uint8_t bit) const {
        const std::uint64_t bits = bit * 0x0101010101010101u;
        for (const Word& word : words_) {
            std::uint64_t flags;
            std::memcpy(&flags, window + word.offset, sizeof flags);
            if (flags & word.mask & bits) return true;
        }
        return false;
    }

  private:
    struct Word {
        std::ptrdiff_t offset;
        std::uint64_t mask;
    };
    std::pmr::vector<Word> words_;
};

}  // namespace dfield::runtime::volume
