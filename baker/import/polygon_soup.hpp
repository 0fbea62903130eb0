// Faces on their way into a TriangleMesh: triangulated, checked, and every one that is left out counted.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "baker/scene.hpp"

namespace dfield {

// A position that import gives up on: NaN and infinities, and magnitudes whose squares leave double's
// comfort.
bool usable_position(const glm::vec3& position);

// Appends the triangles of one face to mesh.triangles and counts it. `corners` index mesh.positions and may
// be out of range. Throws InputError for a face of more than 65,536 corners, naming `file`.
void add_face(TriangleMesh& mesh, ImportReport& report, std::span<const std::uint32_t> corners,
              const std::string& file);

// After the last face: positions that no triangle can use any more (NaN, infinite) become 0, so that whoever
// walks over all vertices meets numbers only; normals are made unit, and missing (zero, NaN) ones are
// computed. `normals` is empty or one per position. crease_degrees only matters when the file has no normals
// at all.
void finish_mesh(TriangleMesh& mesh, float crease_degrees);

}  // namespace dfield
