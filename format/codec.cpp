#include "format/codec.hpp"

#include "format/codec_distances.hpp"
#include "format/codec_mask.hpp"
#include "format/codec_neighbours.hpp"

namespace dfield::codec {
namespace {

// Bytes of one ring after another; ring r + 1 starts at first[r + 1].
std::pmr::vector<std::uint32_t> ring_starts(const FieldParameters& parameters,
                                            std::pmr::memory_resource* memory) {
    const std::uint32_t n = parameters.subdivision, rings = 2 * n + 1;
    std::pmr::vector<std::uint32_t> starts(1, 0, memory);
    starts.reserve(rings + 1);
    for (std::uint32_t r = 0; r < rings; ++r) {
        const std::uint32_t k = std::min(r, 2 * n - r);
        const std::uint32_t size =
            parameters.positions == Positions::kLatlong ? 2 * n + 2 : std::max(1u, 4 * k);
        starts.push_back(starts.back() + size);
    }
    return starts;
}

// Folded residuals out of the streams of their contexts, most significant byte first.
class ResidualDecoder {
  public:
    // `cursors` has two places a context.
    ResidualDecoder(std::uint32_t bits, std::span<const std::byte> raw, std::span<std::uint32_t> cursors)
        : miss_(miss_value(bits)),
          bytes_(bits / 8),
          cursors_(cursors),
          data_(raw.subspan(2 * cursors.size())) {
        std::uint64_t total = 0;
        for (std::size_t i = 0; i < cursors.size(); i += 2) {
            cursors[i] = static_cast<std::uint32_t>(total);
            total += load_le<std::uint32_t>(raw.data() + 2 * i);
            if (total * bytes_ > data_.size()) {
                failed_ = true;
                return;
            }
            cursors[i + 1] = static_cast<std::uint32_t>(total);
        }
        plane_ = static_cast<std::size_t>(total);
        failed_ = plane_ * bytes_ != data_.size();
    }

    std::int32_t code(const Prediction& prediction, std::int32_t) {
        std::uint32_t& cursor = cursors_[2 * prediction.context];
        if (cursor == cursors_[2 * prediction.context + 1]) {
            failed_ = true;
            return 0;
        }
        const std::size_t at = cursor++;
        std::uint32_t folded = 0;
        for (std::size_t i = 0; i < bytes_; ++i)
            folded = folded << 8 | std::to_integer<std::uint32_t>(data_[i * plane_ + at]);
        if (folded >= static_cast<std::uint32_t>(miss_)) {
            failed_ = true;
            return 0;
        }
        return unfold_residual(folded, prediction.value, miss_);
    }
    bool failed() const { return failed_; }
    // Every stream read to its end.
    bool complete() const {
        if (failed_) return false;
        for (std::size_t i = 0; i < cursors_.size(); i += 2)
            if (cursors_[i] != cursors_[i + 1]) return false;
        return true;
    }

  private:
    std::int32_t miss_;
    std::size_t bytes_, plane_ = 0;
    std::span<std::uint32_t> cursors_;
    std::span<const std::byte> data_;
    bool failed_ = false;
};

std::uint16_t folded_word(std::span<const std::byte> raw, std::size_t i) {
    return static_cast<std::uint16_t>(std::to_integer<unsigned>(raw[i]) << 8 |
                                      std::to_integer<unsigned>(raw[raw.size() / 2 + i]));
}

}  // namespace

std::pmr::vector<Neighbours> position_neighbours(const FieldParameters& parameters,
                                                 std::pmr::memory_resource* memory) {
    const auto starts = ring_starts(parameters, memory);
    std::pmr::vector<Neighbours> neighbours(starts.back(), memory);
    for (std::size_t ring = 0; ring + 1 < starts.size(); ++ring) {
        const std::uint32_t first = starts[ring], size = starts[ring + 1] - first;
        for (std::uint32_t j = 0; j < size; ++j)
            neighbours[first + j] = ring_neighbours(ring > 0 ? starts[ring - 1] : 0, first, size, j);
    }
    return neighbours;
}

std::uint64_t plane_bytes(const FieldParameters& parameters) {
    return MaskLayout(parameters).plane_bytes;
}

RawSize mask_size(const FieldParameters& parameters) {
    return {1, 1 + plane_bytes(parameters)};
}

RawSize distances_size(const FieldParameters& parameters) {
    const std::uint64_t counts = 4 * context_count(parameters.bits);
    return {counts, counts + texel_bytes(parameters)};
}

bool decode_mask(const FieldParameters& parameters, std::span<const std::byte> raw,
                 std::span<std::uint8_t> plane, std::pmr::memory_resource* memory) {
    const MaskLayout mask(parameters);
    const auto mode = raw.empty() ? std::byte{255} : raw[0];
    if (mode == std::byte{0}) {  // plain
        if (raw.size() != 1 + plane.size()) return false;
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = std::to_integer<std::uint8_t>(raw[1 + i]);
        const std::uint32_t used = mask.map_size % 8;
        if (used != 0)
            for (std::size_t end = mask.row_bytes; end <= plane.size(); end += mask.row_bytes)
                if (plane[end - 1] >> used != 0) return false;
        return true;
    }
    if (mode != std::byte{1}) return false;
    RangeDecoder decoder(raw.subspan(1));
    code_mask(mask, position_neighbours(parameters, memory), plane.data(), decoder, memory);
    return decoder.complete();
}

bool decode_distances(const FieldParameters& parameters, std::span<const std::byte> raw,
                      std::span<const std::uint8_t> plane, std::span<std::uint8_t> texels,
                      std::pmr::memory_resource* memory) {
    const std::size_t contexts = context_count(parameters.bits);
    if (raw.size() < 4 * contexts) return false;
    std::pmr::vector<std::uint32_t> cursors(2 * contexts, memory);
    ResidualDecoder decoder(parameters.bits, raw, cursors);
    code_distances(parameters, position_neighbours(parameters, memory), plane.data(), texels.data(), decoder,
                   memory);
    return decoder.complete();
}

void pack_plane(const FieldParameters& parameters, std::span<const std::uint8_t> plane,
                std::span<std::uint8_t> texels) {
    const MaskLayout mask(parameters);
    const std::size_t m = parameters.map_size, maps = position_count(parameters),
                      bytes = map_bytes(parameters);
    std::fill(texels.begin(), texels.end(), std::uint8_t{0});
    for (std::size_t map = 0; map < maps; ++map) {
        std::uint8_t* out = texels.data() + map * bytes;
        for (std::size_t t = 0; t < m; ++t) {
            const std::uint8_t* row = plane.data() + mask.row_at(map, t);
            for (std::size_t i = 0; i < mask.row_bytes; ++i) {
                const std::size_t bit = t * m + 8 * i;
                out[bit / 8] = static_cast<std::uint8_t>(out[bit / 8] | row[i] << bit % 8);
                // Past the map's last byte there is only padding.
                const int carried = row[i] >> (8 - bit % 8);
                if (carried != 0) out[bit / 8 + 1] = static_cast<std::uint8_t>(out[bit / 8 + 1] | carried);
            }
        }
    }
}

void decode_mean_depth(const FieldParameters& parameters, std::span<const std::byte> raw,
                       std::span<std::uint16_t> values, std::pmr::memory_resource* memory) {
    const auto neighbours = position_neighbours(parameters, memory);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = unfold_word(folded_word(raw, i), predict_mean_depth(values, neighbours[i]));
}

void decode_self_visibility(std::span<const std::byte> raw, std::span<std::uint16_t> values) {
    std::uint16_t before = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = before = unfold_word(folded_word(raw, i), before);
}

}  // namespace dfield::codec
