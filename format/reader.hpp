// The sections of a .dfield file into a field: the part that read_field and validate_file share.
#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>
#include <span>

#include "format/file.hpp"
#include "format/report.hpp"

namespace dfield {

class FieldReader {
  public:
    // `info` is parsed and its sections are checked (container.hpp).
    FieldReader(std::span<const std::byte> bytes, const FileInfo& info, const ReadLimits& limits,
                Report& report, std::pmr::memory_resource* memory)
        : bytes_(bytes), info_(info), limits_(limits), report_(report), memory_(memory) {}

    // Where the report holds errors afterwards, the field is not to be used.
    void read(DisplacementField& field);

  private:
    // False after an error.
    bool read_field_section(DisplacementField& field);
    bool check_section_set(const FieldParameters& parameters);
    bool check_raw_sizes(const FieldParameters& parameters);
    bool read_texels(DisplacementField& field);
    bool read_self_visibility(DisplacementField& field);
    bool read_provenance(DisplacementField& field);
    bool raw_size_error(const SectionInfo& section, std::uint64_t smallest, std::uint64_t largest);

    std::span<const std::byte> bytes_;
    const FileInfo& info_;
    const ReadLimits& limits_;
    Report& report_;
    std::pmr::memory_resource* memory_;
    std::array<std::byte, 16> digest_{};  // the payload hash that FELD states
};

}  // namespace dfield
