// The adaptive binary range coder of the modelled sections: models of bits and bytes, decoder, encoder.
// FORMAT.md, "Range coder", is normative.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace dfield::codec {

// Probability that the next bit is 1: 24 bits of fraction above an 8 bit count of bits seen, which slows
// adaption from 2/3 of the way to the newest bit down to 1/(kCountLimit + 1.5).
class BitModel {
  public:
    // 16 bit fraction in [1, 65535].
    std::uint32_t probability() const { return (state_ >> 16) | 1; }

    void update(bool bit) {
        const std::uint32_t count = state_ & 255;
        const std::int64_t target = bit ? 0xffffff : 0, current = state_ >> 8;
        const auto next = static_cast<std::uint32_t>(current + (((target - current) * kRates[count]) >> 16));
        state_ = next << 8 | (count < kCountLimit ? count + 1 : count);
    }

  private:
    static constexpr std::uint32_t kCountLimit = 60;
    static constexpr std::array<std::uint32_t, kCountLimit + 1> kRates = [] {
        std::array<std::uint32_t, kCountLimit + 1> rates{};
        for (std::uint32_t i = 0; i <= kCountLimit; ++i)
            rates[i] = 131072 / (2 * i + 3);  // 65536 / (i + 1.5)
        return rates;
    }();
    std::uint32_t state_ = 0x80000000;
};

// A byte, its most significant bit first, each with the model of the bits before it.
using ByteModel = std::array<BitModel, 256>;

template<class Coder>
std::uint8_t code_byte(Coder& coder, ByteModel& model, std::uint8_t value) {
    std::uint32_t node = 1;
    for (int bit = 7; bit >= 0; --bit)
        node = 2 * node + (coder.code(model[node], (value >> bit & 1) != 0) ? 1 : 0);
    return static_cast<std::uint8_t>(node);
}

// Both coders have the same calls, so that a model is written once for both: an encoder is given the bit and
// answers it, a decoder is given anything and answers the bit.
class RangeDecoder {
  public:
    explicit RangeDecoder(std::span<const std::byte> bytes)
        : next_(bytes.data()), end_(next_ + bytes.size()) {
        for (int i = 0; i < 4; ++i) code_ = code_ << 8 | byte();
    }

    bool code(BitModel& model, bool) {
        const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * model.probability() >> 16);
        const bool bit = code_ < bound;
        if (bit) {
            range_ = bound;
        } else {
            code_ -= bound;
            range_ -= bound;
        }
        while (range_ < 1u << 24) {
            range_ <<= 8;
            code_ = code_ << 8 | byte();
        }
        model.update(bit);
        return bit;
    }
    bool failed() const { return overrun_; }
    // Every byte read, and the final state is the encoder's.
    bool complete() const { return !overrun_ && next_ == end_ && code_ == 0; }

  private:
    std::uint32_t byte() {
        if (next_ == end_) {
            overrun_ = true;
            return 0;
        }
        return std::to_integer<std::uint32_t>(*next_++);
    }

    const std::byte *next_, *end_;
    std::uint32_t range_ = 0xffffffff, code_ = 0;
    bool overrun_ = false;
};

// With carry propagation, after Schindler and the LZMA SDK (there, the first byte is always 0 and kept; here
// it is dropped).
class RangeEncoder {
  public:
    bool code(BitModel& model, bool bit) {
        const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * model.probability() >> 16);
        if (bit) {
            range_ = bound;
        } else {
            low_ += bound;
            range_ -= bound;
        }
        while (range_ < 1u << 24) {
            range_ <<= 8;
            shift();
        }
        model.update(bit);
        return bit;
    }
    static constexpr bool failed() { return false; }

    // Ends the stream. Call once.
    std::vector<std::byte> finish() {
        for (int i = 0; i < 5; ++i) shift();
        return std::move(bytes_);
    }

  private:
    void shift() {
        if (low_ < 0xff000000u || low_ >> 32 != 0) {
            const auto carry = static_cast<unsigned>(low_ >> 32);
            if (started_) bytes_.push_back(static_cast<std::byte>(held_ + carry));
            for (; pending_ > 0; --pending_) bytes_.push_back(static_cast<std::byte>(0xff + carry));
            held_ = static_cast<std::uint8_t>(low_ >> 24);
            started_ = true;
        } else {
            ++pending_;
        }
        low_ = (low_ & 0x00ffffff) << 8;
    }

    std::vector<std::byte> bytes_;
    std::uint64_t low_ = 0, pending_ = 0;  // pending: bytes 0xff that a carry would turn
    std::uint32_t range_ = 0xffffffff;
    std::uint8_t held_ = 0;
    bool started_ = false;
};

}  // namespace dfield::codec
