// Writes GLBs: vectors, indices, materials, meshes and nodes as they come.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "models/shapes.hpp"

namespace dfield::models {

using Json = nlohmann::ordered_json;

class GlbBuilder {
  public:
    Json json;  // the document; complete it as you like before finish()

    explicit GlbBuilder(const char* scene_name);

    std::size_t add_vectors(std::span<const glm::dvec3> vectors, bool with_bounds);
    // 16-bit indices, quads as two triangles.
    std::size_t add_indices(std::span<const Face> faces);
    std::size_t add_material(const char* name, const glm::dvec3& colour, bool double_sided);
    // One normal a face: every face gets its own vertices, and with `colours`, one a position, COLOR_0.
    std::size_t add_faceted(const char* name, const Shape& shape, std::size_t material,
                            std::span<const glm::dvec3> colours = {});
    // Appends to one of the document's lists; returns the index there.
    std::size_t append(const char* list, Json entry);
    std::size_t add_root(Json node);  // a node of the scene

    std::string finish();

  private:
    std::size_t add_view(std::size_t start, int target);

    std::string binary_;
};

// A node turned about y.
Json placed_node(const char* name, const glm::dvec3& translation, double yaw_degrees,
                 const glm::dvec3& scale);

}  // namespace dfield::models
