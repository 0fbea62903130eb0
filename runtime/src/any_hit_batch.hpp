// Whether lines hit a field at all, many at once: every texel is found and asked for before the first is
// read, since a lookup is a chain of roots and divisions that ends in a cache miss.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lookup.hpp"

namespace dfield::runtime {

class AnyHitBatch {
  public:
    static constexpr std::size_t kCapacity = 256;

    // A line whose hits count from t > minimum on; `id` names it in look_up. in_front: no hit lies at or
    // before `minimum`, wherever the line's origin is. The caller keeps to the capacity.
    void add(const Chord& chord, std::uint16_t id, float minimum, bool in_front) {
        if (chord.t_out() > minimum) lines_[count_++] = {chord, {}, minimum, id, in_front};
    }

    // Calls hit(id) for each line that hits, and empties the batch.
    template<int kBits, class Hit>
    void look_up(const dfield_field& field, const Hit& hit) {
        for (std::size_t k = 0; k < count_; ++k) {
            Line& line = lines_[k];
            // From outside the sphere every hit is ahead. From inside the exit point is asked, looking back:
            // it knows the last hit on the line, and its sample lies farther from the origin.
            const bool outside = line.chord.t_in() >= line.minimum;
            line.any_depth |= outside;
            line.probe = probe_line(field, line.chord, outside ? LineEnd::kEntry : LineEnd::kExit);
            prefetch(texel_address(field, line.probe));
        }
        for (std::size_t k = 0; k < count_; ++k) {
            const Line& line = lines_[k];
            if (probe_hits<kBits>(field, line.probe) &&
                (line.any_depth || hit_parameter<kBits>(field, line.chord, line.probe) > line.minimum))
                hit(line.id);
        }
        count_ = 0;
    }

  private:
    struct Line {
        Chord chord;
        Probe probe;
        float minimum;
        std::uint16_t id;
        bool any_depth;  // a hit counts wherever on the line it lies
    };
    std::array<Line, kCapacity> lines_;
    std::size_t count_ = 0;
};

}  // namespace dfield::runtime
