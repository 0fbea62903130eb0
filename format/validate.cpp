#include "format/container.hpp"
#include "format/file.hpp"
#include "format/reader.hpp"
#include "format/report.hpp"

namespace dfield {

std::vector<Finding> validate_file(std::span<const std::byte> bytes, const ReadLimits& limits) {
    std::vector<Finding> findings;
    Report report(findings);
    const auto info = parse_header(bytes, report);
    if (info && check_sections(bytes, *info, report)) {
        DisplacementField field;
        FieldReader(bytes, *info, {limits}, report, std::pmr::get_default_resource()).read(field);
    }
    return findings;
}

}  // namespace dfield
