// An NRRD's header as text: which lines teem may see, and where the voxels are. Teem believes what it reads:
// sizes wrap around, names of data files are printf formats, trailing rubbish is overlooked. So numbers are
// checked here, and teem is never shown the name of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace dfield {

struct NrrdHeader {
    std::string fields;  // the magic and the fields that tell of the voxels and their place, a line each
    std::string unit;    // the first one that is given, of length
    std::vector<std::filesystem::path> data_files;  // in order; the header's own file where it has the voxels
    std::uint64_t data_offset = 0;                  // where they begin in each of them
    std::size_t piece_axes = 0;  // axes that a data file holds, 0 where the header does not say
    bool detached = false;
};

// Throws InputError. Data files need not exist.
NrrdHeader read_nrrd_header(const std::filesystem::path& path);

}  // namespace dfield
