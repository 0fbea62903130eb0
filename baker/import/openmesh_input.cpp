#include "baker/import/openmesh_input.hpp"

#include <bit>
#include <cmath>

#include "baker/import/text_scan.hpp"

namespace dfield {

void append_word(std::string& bytes, std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xff);
}

void append_float(std::string& bytes, float value) {
    append_word(bytes, std::bit_cast<std::uint32_t>(std::isfinite(value) ? value : kNotFinite));
}

OpenMeshInput make_ply(std::uint64_t vertices, bool normals, const std::string& vertex_bytes,
                       std::uint64_t faces, const std::string& face_bytes) {
    OpenMeshInput ply;
    ply.extension = "ply";
    ply.binary = true;
    ply.vertices = vertices;
    ply.faces = faces;
    ply.bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
                "\nproperty float x\nproperty float y\nproperty float z\n";
    if (normals) ply.bytes += "property float nx\nproperty float ny\nproperty float nz\n";
    // OpenMesh does not take "uint" as a list's type.
    ply.bytes +=
        "element face " + std::to_string(faces) + "\nproperty list int int vertex_indices\nend_header\n";
    ply.bytes.reserve(ply.bytes.size() + vertex_bytes.size() + face_bytes.size());
    ply.bytes += vertex_bytes;
    ply.bytes += face_bytes;
    return ply;
}

}  // namespace dfield
