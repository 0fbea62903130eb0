#include <bit>

#include "baker/error.hpp"
#include "baker/import/openmesh_input.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes; the header is 80 free bytes and the count

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i)
        word |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return word;
}

bool starts_with_solid(std::string_view bytes) {
    const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && equal_ignoring_case(bytes.substr(begin, 5), "solid");
}

// Appends the facets to `facets` and returns their number. Facet normals are not kept: the winding says them.
std::uint64_t read_text(const std::string& file, std::string_view bytes, std::string& facets) {
    TextScanner scan(file, bytes, 0);
    const auto expect = [&](std::string_view word) {
        const std::string_view found = scan.token(word);
        if (!equal_ignoring_case(found, word))
            scan.fail("expected " + quoted(word) + ", found " + quoted(found));
    };
    std::uint64_t count = 0;
    while (!scan.at_end()) {
        expect("solid");
        scan.skip_line();  // the name
        for (;;) {
            const std::string_view word = scan.token("facet or endsolid");
            if (equal_ignoring_case(word, "endsolid")) break;
            if (!equal_ignoring_case(word, "facet"))
                scan.fail("expected 'facet' or 'endsolid', found " + quoted(word));
            scan.skip_line();  // its normal
            expect("outer");
            expect("loop");
            facets.append(12, '\0');
            for (int corner = 0; corner < 3; ++corner) {
                expect("vertex");
                for (int k = 0; k < 3; ++k) append_float(facets, scan.number("a coordinate"));
            }
            expect("endloop");
            expect("endfacet");
            facets.append(2, '\0');
            ++count;
        }
        scan.skip_line();
    }
    return count;
}

}  // namespace

OpenMeshInput reduce_stl(const std::string& file, std::string_view bytes) {
    OpenMeshInput result;
    result.extension = "stl";
    result.binary = true;
    result.welded = true;
    result.bytes.assign(kHeader, '\0');

    const std::uint64_t promised = bytes.size() >= kHeader ? word_at(bytes, 80) : 0;
    const std::uint64_t size = kHeader + kFacet * promised;
    // Many binary files start with "solid" too; only the size tells. Whether a text fits it by chance is not
    // a worry.
    if (bytes.size() >= kHeader && bytes.size() == size) {
        result.faces = promised;
        result.bytes.reserve(bytes.size());
        for (std::size_t at = kHeader; at < bytes.size(); at += kFacet) {
            for (std::size_t k = 0; k < 12; ++k)
                append_float(result.bytes, std::bit_cast<float>(word_at(bytes, at + 4 * k)));
            result.bytes.append(2, '\0');
        }
    } else if (starts_with_solid(bytes)) {
        result.faces = read_text(file, bytes, result.bytes);
    } else {
        throw InputError(
            file +
            ": neither text STL (it does not start with 'solid') nor binary STL: the header promises " +
            std::to_string(promised) + " triangles, which take " + std::to_string(size) +
            " bytes, and the file has " + std::to_string(bytes.size()));
    }
    if (result.faces > 0xffffffff) throw InputError(file + ": more than 2^32 - 1 triangles");
    std::string count;
    append_word(count, static_cast<std::uint32_t>(result.faces));
    result.bytes.replace(80, 4, count);
    return result;
}

}  // namespace dfield
