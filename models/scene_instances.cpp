#include "models/scene_instances.hpp"

#include <cmath>
#include <glm/trigonometric.hpp>

#include "models/glb_builder.hpp"

namespace dfield::models {
namespace {

std::size_t add_room(GlbBuilder& glb, double side, std::size_t material) {
    const Shape room = corner(side);
    std::vector<glm::dvec3> normals;
    std::vector<Face> faces;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        glm::dvec3 normal(0);
        normal[static_cast<int>(axis)] = 1;
        normals.insert(normals.end(), kCornerVertices * kCornerVertices, normal);
        faces.insert(faces.end(), room.parts[axis].faces.begin(), room.parts[axis].faces.end());
    }
    Json attributes = {{"POSITION", glb.add_vectors(room.positions, true)},
                       {"NORMAL", glb.add_vectors(normals, false)}};
    Json primitive = {
        {"attributes", attributes}, {"indices", glb.add_indices(faces)}, {"material", material}};
    return glb.append("meshes", {{"name", "room"}, {"primitives", Json::array({primitive})}});
}

// Wood and leaves are two primitives that share their positions and have no normals: readers have to make
// them.
std::size_t add_tree(GlbBuilder& glb, std::size_t wood, std::size_t leaf) {
    const Shape tree = leafy_tree();
    const std::size_t position = glb.add_vectors(tree.positions, true);
    Json primitives = Json::array();
    for (std::size_t i = 0; i < 2; ++i)
        primitives.push_back({{"attributes", {{"POSITION", position}}},
                              {"indices", glb.add_indices(tree.parts[i].faces)},
                              {"material", i == 0 ? wood : leaf}});
    return glb.append("meshes", {{"name", "leafy_tree"}, {"primitives", std::move(primitives)}});
}

}  // namespace

std::string scene_instances_glb() {
    GlbBuilder glb("instances");
    const std::size_t wall = glb.add_material("wall", {0.8, 0.78, 0.74}, false);
    const std::size_t stone = glb.add_material("stone", {0.7, 0.7, 0.72}, false);
    const std::size_t wood = glb.add_material("wood", {0.35, 0.24, 0.15}, false);
    const std::size_t leaf = glb.add_material("leaf", {0.18, 0.42, 0.1}, true);
    const std::size_t room = add_room(glb, 8, wall);
    const std::size_t cube = glb.add_faceted("cube_with_hole", cube_with_hole(), stone);
    const std::size_t tree = add_tree(glb, wood, leaf);

    const auto with_mesh = [](Json entry, std::size_t mesh) {
        entry["mesh"] = mesh;
        return entry;
    };
    const auto at_root = [&](Json entry) { return glb.add_root(std::move(entry)); };
    at_root({{"name", "room"}, {"mesh", room}});
    at_root(with_mesh(placed_node("tree", {2.4, 0, 2.2}, 0, {1, 1, 1}), tree));
    at_root(with_mesh(placed_node("tree_slim", {5.9, 0, 1.9}, 130, {0.7, 1.05, 0.7}), tree));
    at_root(with_mesh(placed_node("tree_mirrored", {1.8, 0, 5.8}, 40, {-0.85, 0.75, 0.85}), tree));
    at_root(with_mesh(placed_node("cube", {4.6, 0.5, 4.2}, 30, {1, 1, 1}), cube));
    at_root(with_mesh(placed_node("cube_mirrored", {3.4, 0.45, 6.6}, -20, {0.9, 0.9, -0.9}), cube));
    at_root(with_mesh(placed_node("cube_flat", {6.4, 0.3, 3.6}, 65, {1.4, 0.6, 0.8}), cube));

    // A turned child under a non-uniformly scaled parent: the product is a shear.
    const std::size_t group = at_root(placed_node("squeezed", {5.6, 0, 5.9}, 15, {1.6, 1, 0.7}));
    const std::size_t lower =
        glb.append("nodes", with_mesh(placed_node("cube_sheared", {0, 0.4, 0}, 40, {0.8, 0.8, 0.8}), cube));
    const std::size_t upper = glb.append(
        "nodes", with_mesh(placed_node("cube_sheared_mirrored", {0, 1.05, 0}, -25, {-0.5, 0.5, 0.5}), cube));
    glb.json["nodes"][group]["children"] = {lower, upper};
    return glb.finish();
}

}  // namespace dfield::models
