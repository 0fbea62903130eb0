// The writing half of codec.hpp.
#include "format/codec.hpp"
#include "format/codec_distances.hpp"
#include "format/codec_mask.hpp"
#include "format/codec_neighbours.hpp"

namespace dfield::codec {
namespace {

struct ResidualEncoder {
    std::int32_t miss;
    std::vector<std::vector<std::uint32_t>> streams;  // folded residuals by context

    std::int32_t code(const Prediction& prediction, std::int32_t value) {
        streams[prediction.context].push_back(fold_residual(value, prediction.value, miss));
        return value;
    }
    static constexpr bool failed() { return false; }
};

template<class Predict>
std::vector<std::byte> encode_words(std::span<const std::uint16_t> values, const Predict& predict) {
    std::vector<std::byte> raw(2 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint16_t folded = fold_word(values[i], predict(i));
        raw[i] = static_cast<std::byte>(folded >> 8);
        raw[values.size() + i] = static_cast<std::byte>(folded & 255);
    }
    return raw;
}

}  // namespace

std::vector<std::uint8_t> plane_of_texels(const FieldParameters& parameters,
                                          std::span<const std::uint8_t> texels) {
    const MaskLayout mask(parameters);
    const std::size_t m = parameters.map_size, maps = position_count(parameters),
                      bytes = map_bytes(parameters);
    const std::uint32_t bits = parameters.bits;
    std::vector<std::uint8_t> plane(mask.plane_bytes);
    const auto hit = [&](const std::uint8_t* map, std::size_t i) {
        if (bits == 1) return (map[i / 8] >> i % 8 & 1) != 0;
        if (bits == 8) return map[i] != kMiss8;
        if (bits == 16) return load_le<std::uint16_t>(map + 2 * i) != kMiss16;
        return load_float(map + 4 * i) != kMiss32;
    };
    for (std::size_t map = 0; map < maps; ++map)
        for (std::size_t t = 0; t < m; ++t)
            for (std::size_t s = 0; s < m; ++s)
                if (hit(texels.data() + map * bytes, t * m + s))
                    plane[mask.row_at(map, t) + s / 8] |= static_cast<std::uint8_t>(1 << s % 8);
    return plane;
}

std::vector<std::byte> encode_mask(const FieldParameters& parameters, std::span<const std::uint8_t> plane) {
    const MaskLayout mask(parameters);
    auto* memory = std::pmr::get_default_resource();
    RangeEncoder encoder;
    std::vector<std::uint8_t> work(plane.begin(), plane.end());
    code_mask(mask, position_neighbours(parameters, memory), work.data(), encoder, memory);
    std::vector<std::byte> raw = encoder.finish();
    raw.insert(raw.begin(), std::byte{1});  // the section's mode
    if (raw.size() > 1 + plane.size()) {    // noise: plain, mode 0
        raw.assign(1 + plane.size(), std::byte{0});
        std::transform(plane.begin(), plane.end(), raw.begin() + 1,
                       [](std::uint8_t byte) { return std::byte{byte}; });
    }
    return raw;
}

EncodedDistances encode_distances(const FieldParameters& parameters, std::span<const std::uint8_t> plane,
                                  std::span<const std::uint8_t> texels) {
    auto* memory = std::pmr::get_default_resource();
    const std::uint32_t bits = parameters.bits, contexts = context_count(bits);
    ResidualEncoder encoder{miss_value(bits), std::vector<std::vector<std::uint32_t>>(contexts)};
    code_distances(parameters, position_neighbours(parameters, memory), plane.data(), texels.data(), encoder,
                   memory);
    EncodedDistances result;
    result.raw.resize(4 * contexts);
    for (std::uint32_t c = 0; c < contexts; ++c)
        store_le(&result.raw[4 * c], static_cast<std::uint32_t>(encoder.streams[c].size()));
    for (int shift = static_cast<int>(bits) - 8; shift >= 0; shift -= 8)
        for (const auto& stream : encoder.streams) {
            result.stream_ends.push_back(result.raw.size());
            for (const std::uint32_t folded : stream)
                result.raw.push_back(static_cast<std::byte>(folded >> shift & 255));
        }
    result.stream_ends.push_back(result.raw.size());
    return result;
}

std::vector<std::byte> encode_mean_depth(const FieldParameters& parameters,
                                         std::span<const std::uint16_t> values) {
    const auto neighbours = position_neighbours(parameters, std::pmr::get_default_resource());
    return encode_words(values, [&](std::size_t i) { return predict_mean_depth(values, neighbours[i]); });
}

std::vector<std::byte> encode_self_visibility(std::span<const std::uint16_t> values) {
    return encode_words(values, [&](std::size_t i) { return i > 0 ? values[i - 1] : std::uint16_t{0}; });
}

}  // namespace dfield::codec
