// Little-endian numbers in bytes, independent of the machine's own order and alignment.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace dfield {

template<std::unsigned_integral T, class Byte>
constexpr T load_le(const Byte* bytes) {
    static_assert(sizeof(Byte) == 1);
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << (8 * i)));
    return value;
}

template<std::unsigned_integral T, class Byte>
constexpr void store_le(Byte* bytes, T value) {
    static_assert(sizeof(Byte) == 1);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<Byte>(value >> (8 * i));
}

template<class Byte>
float load_float(const Byte* bytes) {
    return std::bit_cast<float>(load_le<std::uint32_t>(bytes));
}

template<class Byte>
void store_float(Byte* bytes, float value) {
    store_le(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace dfield
