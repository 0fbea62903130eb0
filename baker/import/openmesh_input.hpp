// What OpenMesh's readers are given instead of the file itself.
//
// Those readers believe the counts of a header before they look at the file, read a cut-off file to the end
// by repeating its last face, drop or shift vertices where a number says "nan", drop or reshape faces that
// name a vertex twice, lose step at properties and comments that they do not know, and open whatever file
// `mtllib` names. So each file is first walked with all bounds checked, and reduced to the part that they
// read faithfully: positions, normals and faces. Numbers that are not finite become kNotFinite
// (text_scan.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dfield {

struct OpenMeshInput {
    std::string bytes;      // a whole file in the format that `extension` names
    std::string extension;  // "obj", "ply" or "stl"
    bool binary = false;
    std::uint64_t faces = 0;     // in `bytes`; OpenMesh delivers this many (fewer only for STL: see `welded`)
    std::uint64_t vertices = 0;  // likewise
    bool welded =
        false;  // STL: OpenMesh joins equal positions, and leaves out triangles that then have no area
    // Faces that OpenMesh would reshape or drop (a vertex named twice, fewer than 3 corners): vertex indices.
    std::vector<std::vector<std::uint32_t>> other_faces;
    std::uint64_t skipped = 0;  // OBJ points and lines
};

constexpr std::uint32_t kNoVertex = ~0u;  // an index that is out of range whatever the file holds

// Little-endian, as binary PLY and STL are written here.
void append_word(std::string& bytes, std::uint32_t word);
void append_float(std::string& bytes, float value);  // kNotFinite for what is not finite

// A binary PLY of float vertices (x y z, and nx ny nz with `normals`) and faces (a count and indices, 32 bits
// each).
OpenMeshInput make_ply(std::uint64_t vertices, bool normals, const std::string& vertex_bytes,
                       std::uint64_t faces, const std::string& face_bytes);

// All throw InputError, naming `file`, where the file cannot be made sense of.
OpenMeshInput reduce_obj(const std::string& file, std::string_view bytes);
// OFF comes out as PLY: OpenMesh's OFF reader looks at its header only where it opens the file itself, and
// from a stream misses the normals.
OpenMeshInput reduce_off(const std::string& file, std::string_view bytes);
OpenMeshInput reduce_ply(const std::string& file, std::string_view bytes);
OpenMeshInput reduce_stl(const std::string& file, std::string_view bytes);

}  // namespace dfield
