#include "baker/import/openmesh_input.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {
namespace {

// [ST][C][N]OFF, with 4 and n for other dimensions; ModelNet's files have the counts glued to it ("OFF8 6
// 0").
struct OffHeader {
    bool normals = false;
    std::string_view glued_count;
};

OffHeader parse_header(TextScanner& scan, std::string_view word) {
    OffHeader header;
    const std::size_t off = word.find("OFF");
    if (off == std::string_view::npos ||
        word.substr(0, off).find_first_not_of("STCN4n") != std::string_view::npos)
        scan.fail("an OFF file starts with OFF, COFF, NOFF or a like word");
    const std::string_view prefix = word.substr(0, off);
    if (prefix.find_first_of("4n") != std::string_view::npos)
        scan.fail("OFF files of other dimensions than three (4OFF, nOFF) are not supported");
    header.normals = prefix.find('N') != std::string_view::npos;
    header.glued_count = word.substr(off + 3);
    return header;
}

// The number of edges, which nobody keeps: behind the others, alone on the next line, or left out.
void skip_edge_count(TextScanner& scan) {
    if (scan.token_on_line().empty()) {
        TextScanner ahead = scan;
        const bool alone = !ahead.at_end() && !ahead.token_on_line().empty() && ahead.token_on_line().empty();
        if (alone) scan = ahead;
    }
    scan.skip_line();
}

}  // namespace

OpenMeshInput reduce_off(const std::string& file, std::string_view bytes) {
    TextScanner scan(file, bytes, '#');
    const OffHeader header = parse_header(scan, scan.token("the word OFF"));
    {
        TextScanner ahead = scan;
        if (!ahead.at_end() && ahead.token_on_line() == "BINARY")
            scan.fail(
                "binary OFF is not supported (its byte order is not defined): export as text, or as PLY");
    }
    std::uint64_t vertices = 0;
    if (header.glued_count.empty()) {
        vertices = scan.count("the number of vertices");
    } else if (const auto glued = parse_integer(header.glued_count);
               glued && *glued >= 0 && *glued <= 0xffffffff) {
        vertices = static_cast<std::uint64_t>(*glued);
    } else {
        scan.fail("an OFF file starts with OFF, COFF, NOFF or a like word");
    }
    const std::uint64_t faces = scan.count("the number of faces");
    skip_edge_count(scan);

    // The shortest vertex is "0 0 0\n", the shortest face "0\n".
    if (6 * vertices + 2 * faces > scan.bytes_left() + 1)
        scan.fail("the header promises " + std::to_string(vertices) + " vertices and " +
                  std::to_string(faces) + " faces, but only " + std::to_string(scan.bytes_left()) +
                  " bytes follow");

    std::string vertex_bytes, face_bytes;
    for (std::uint64_t i = 0; i < vertices; ++i) {
        for (int k = 0; k < (header.normals ? 6 : 3); ++k)
            append_float(vertex_bytes, scan.number("a number of a vertex"));
        scan.skip_line();  // colours, texture coordinates
    }
    for (std::uint64_t i = 0; i < faces; ++i) {
        const std::uint64_t corners = scan.count("the corner count of a face");
        if (corners > scan.bytes_left() / 2 + 1)
            scan.fail("a face promises " + std::to_string(corners) + " corners, more than the file can hold");
        append_word(face_bytes, static_cast<std::uint32_t>(corners));
        for (std::uint64_t k = 0; k < corners; ++k) {
            const std::int64_t index = scan.integer("a vertex index");
            const bool inside = index >= 0 && index < static_cast<std::int64_t>(vertices);
            append_word(face_bytes, inside ? static_cast<std::uint32_t>(index) : kNoVertex);
        }
        scan.skip_line();  // colours
    }
    return make_ply(vertices, header.normals, vertex_bytes, faces, face_bytes);
}

}  // namespace dfield
