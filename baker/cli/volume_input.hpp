// A volume on the command line: its file, and what raw voxels do not say themselves.
#pragma once

#include <memory>
#include <string>

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/report.hpp"
#include "baker/volume/read_volume.hpp"

namespace dfield::cli {

// FILE --dims --type --spacing --endian --header-bytes
struct VolumeInput {
    std::string file;
    std::string dims, type, spacing;
    std::endian endian = std::endian::little;
    std::uint64_t header_bytes = 0;
};

void add_volume_input(CLI::App& command, VolumeInput& input);

// What the flags say, checked. Call after parsing. Throws Error of usage.
VolumeReadOptions volume_read_options(const VolumeInput& input);

// Reads the volume; what is odd about it goes to stderr. Throws Error.
Volume read_volume_input(const VolumeInput& input);

// file, format, dims, type, voxels, spacing, origin, directions, space, unit, right_handed: what reports say
// of their volume.
Json volume_json(const VolumeInput& input, const Volume& volume);

}  // namespace dfield::cli
