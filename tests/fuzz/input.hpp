// Bytes of a fuzzer's input as numbers; zeros after its end.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>

namespace dfield::fuzz {

inline void require(bool condition) {
    if (!condition) std::abort();
}

class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    std::size_t left() const { return size_; }
    bool empty() const { return size_ == 0; }

    std::uint8_t byte() {
        if (size_ == 0) return 0;
        --size_;
        return *data_++;
    }

    // Mostly small ones, which make invertible matrices and rays that meet the objects, now and then the odd
    // ones, and any bits at all.
    float number() {
        static constexpr float kOdd[] = {0.0f,   -0.0f,  1.0f,  NAN,   INFINITY, -INFINITY,    1e-45f,
                                         1e-38f, 1e-20f, 1e20f, 3e38f, -3e38f,   3.4028235e38f};
        const std::uint8_t choice = byte();
        if (choice < 224) return static_cast<float>(static_cast<std::int8_t>(byte())) / 16;
        if (choice < 248) return kOdd[byte() % std::size(kOdd)];
        std::uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
        return std::bit_cast<float>(bits);
    }

    // Of a float4x4, column by column: the identity with up to seven entries changed, those of the last row
    // seldom.
    std::array<float, 16> transform() {
        std::array<float, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        for (std::uint8_t changes = byte() % 8; changes > 0; --changes) {
            const std::uint8_t at = byte() % 20;
            m[at < 16 ? at : 12 + at % 3] = number();
        }
        return m;
    }

  private:
    const std::uint8_t* data_;
    std::size_t size_;
};

}  // namespace dfield::fuzz
