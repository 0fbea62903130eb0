// Encoding a displacement field as .dfield bytes. A separate target: the runtime does not carry it.
#pragma once

#include <cstddef>
#include <vector>

#include "format/field.hpp"

namespace dfield {

struct WriteOptions {
    int zstd_level = 19;
    int threads = 1;  // above 1 the sections are compressed at the same time; the bytes are equal
};

// Throws std::invalid_argument when the field breaks a rule of the format (sizes, ranges, NaN).
std::vector<std::byte> write_field(const DisplacementField& field, const WriteOptions& options = {});

}  // namespace dfield
