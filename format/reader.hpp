// The sections of a .dfield file into a field: the part that read_field and validate_file share.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>

#include "format/file.hpp"
#include "format/hash.hpp"
#include "format/report.hpp"

namespace dfield {

class FieldReader {
  public:
    // `info` is parsed and its sections are checked (container.hpp).
    FieldReader(std::span<const std::byte> bytes, const FileInfo& info, const ReadOptions& options,
                Report& report, std::pmr::memory_resource* memory)
        : bytes_(bytes), info_(info), options_(options), report_(report), memory_(memory) {}

    // Where the report holds errors afterwards, the field is not to be used.
    void read(DisplacementField& field);

  private:
    // False after an error.
    bool read_field_section(DisplacementField& field);
    bool check_section_set(const FieldParameters& parameters);
    bool check_raw_sizes(const FieldParameters& parameters);
    bool read_texels(DisplacementField& field);
    bool read_lines(DisplacementField& field);
    bool read_directions(DisplacementField& field);
    bool read_volume(DisplacementField& field);
    bool read_self_visibility(DisplacementField& field);
    bool read_provenance(DisplacementField& field);
    // A section's raw bytes and what is wrong with them to the report.
    template<class Decode>
    bool decode_section(const SectionInfo& section, const Decode& decode);
    // Where everything that FELD's hash covers is read.
    bool covers_hash() const;
    bool raw_size_error(const SectionInfo& section, std::uint64_t smallest, std::uint64_t largest);

    std::span<const std::byte> bytes_;
    const FileInfo& info_;
    const ReadOptions& options_;
    Report& report_;
    std::pmr::memory_resource* memory_;
    FieldParameters stored_;  // of the file's displacement maps, whether they are read or not
    Digest digest_{};         // that FELD states
};

}  // namespace dfield
