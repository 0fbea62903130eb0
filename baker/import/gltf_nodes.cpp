#include "baker/import/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "baker/error.hpp"
#include "baker/import/gltf_accessor.hpp"

namespace dfield {
namespace {

std::string node_words(const std::vector<SceneNode>& nodes, std::size_t i) {
    return "node " + std::to_string(i) + " ('" + nodes[i].name + "')";
}

glm::dmat4 from_trs(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    // Quantised quaternions are a little off unit length; a zero one turns nothing.
    const double length = glm::length(rotation);
    const glm::dmat4 turned = length > 0 ? glm::mat4_cast(rotation / length) : glm::dmat4(1);
    return glm::scale(glm::translate(glm::dmat4(1), translation) * turned, scale);
}

glm::dmat4 local_transform(const GltfDocument& document, const std::vector<SceneNode>& nodes,
                           std::size_t index) {
    const tinygltf::Node& node = document.model.nodes[index];
    const auto check = [&](const std::vector<double>& numbers, std::size_t size, const char* what) {
        if (!numbers.empty() && numbers.size() != size)
            throw InputError(document.file + ": " + node_words(nodes, index) + ": " + what + " needs " +
                             std::to_string(size) + " numbers");
        return !numbers.empty();
    };
    glm::dmat4 matrix(1);
    if (check(node.matrix, 16, "matrix")) {
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                matrix[column][row] = node.matrix[static_cast<std::size_t>(4 * column + row)];
        return matrix;
    }
    glm::dvec3 translation(0), scale(1);
    glm::dquat rotation(1, 0, 0, 0);
    if (check(node.translation, 3, "translation"))
        translation = {node.translation[0], node.translation[1], node.translation[2]};
    if (check(node.rotation, 4, "rotation"))
        rotation = glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (check(node.scale, 3, "scale")) scale = {node.scale[0], node.scale[1], node.scale[2]};
    return from_trs(translation, rotation, scale);
}

// The transforms of a node's GPU instances, before its own.
std::vector<glm::dmat4> gpu_instances(const GltfDocument& document, const tinygltf::Value& extension,
                                      const std::string& where) {
    const tinygltf::Value& attributes = extension.Get("attributes");
    const auto accessor = [&](const char* name) {
        if (!attributes.IsObject() || !attributes.Has(name)) return -1;
        if (!attributes.Get(name).IsInt())
            throw InputError(document.file + ": " + where + name + " is no accessor");
        return attributes.Get(name).GetNumberAsInt();
    };
    if (!attributes.IsObject() || attributes.Keys().empty())
        throw InputError(document.file + ": " + where + "there are no attributes");
    // Custom attributes (_ID, ...) give the number of instances too.
    std::size_t count = 0;
    bool first = true;
    for (const std::string& name : attributes.Keys()) {
        const std::size_t found = accessor_count(document, accessor(name.c_str()), where + name);
        if (!first && found != count)
            throw InputError(document.file + ": " + where + "attributes differ in length");
        count = found;
        first = false;
    }
    const auto numbers = [&](const char* name, int components) {
        const int index = accessor(name);
        return index < 0 ? std::vector<float>() : read_accessor(document, index, components, where + name);
    };
    const std::vector<float> translations = numbers("TRANSLATION", 3), rotations = numbers("ROTATION", 4),
                             scales = numbers("SCALE", 3);
    if (translations.empty() && rotations.empty() && scales.empty()) {
        if (count > 65536)
            throw InputError(document.file + ": " + where + "too many instances without a transform");
        return std::vector<glm::dmat4>(count, glm::dmat4(1));
    }
    std::vector<glm::dmat4> transforms;
    transforms.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        glm::dvec3 translation(0), scale(1);
        glm::dquat rotation(1, 0, 0, 0);
        if (!translations.empty())
            translation = {translations[3 * i], translations[3 * i + 1], translations[3 * i + 2]};
        if (!rotations.empty())
            rotation = glm::dquat(rotations[4 * i + 3], rotations[4 * i], rotations[4 * i + 1],
                                  rotations[4 * i + 2]);
        if (!scales.empty()) scale = {scales[3 * i], scales[3 * i + 1], scales[3 * i + 2]};
        transforms.push_back(from_trs(translation, rotation, scale));
    }
    return transforms;
}

std::vector<std::size_t> roots_to_draw(const GltfDocument& document, const std::vector<SceneNode>& nodes) {
    const tinygltf::Model& model = document.model;
    std::vector<std::size_t> roots;
    if (model.defaultScene < 0) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (nodes[i].parent < 0) roots.push_back(i);
        return roots;
    }
    if (static_cast<std::size_t>(model.defaultScene) >= model.scenes.size())
        throw InputError(document.file + ": its default scene " + std::to_string(model.defaultScene) +
                         " does not exist");
    for (const int index : model.scenes[static_cast<std::size_t>(model.defaultScene)].nodes) {
        if (index < 0 || static_cast<std::size_t>(index) >= nodes.size())
            throw InputError(document.file + ": the scene names node " + std::to_string(index) +
                             ", which does not exist");
        roots.push_back(static_cast<std::size_t>(index));
    }
    return roots;
}

SceneCamera placed_camera(const GltfDocument& document, const std::string& where, int index,
                          const glm::dmat4& world) {
    const std::vector<SceneCamera>& known = document.looks.cameras;
    if (static_cast<std::size_t>(index) >= known.size())
        throw InputError(document.file + ": " + where + " has camera " + std::to_string(index) +
                         ", which does not exist");
    SceneCamera camera = known[static_cast<std::size_t>(index)];
    const glm::dvec3 back = glm::normalize(glm::dvec3(world[2]));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(world[1]), back));
    const glm::dmat4 pose(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0),
                          glm::dvec4(glm::dvec3(world[3]), 1));
    camera.to_world = glm::mat4(pose);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(camera.to_world[column][row]))
                throw InputError(document.file + ": " + where +
                                 " has a camera and a transform that is flat or not finite");
    return camera;
}

}  // namespace

std::vector<SceneNode> gltf_nodes(const GltfDocument& document) {
    const std::vector<tinygltf::Node>& source = document.model.nodes;
    std::vector<SceneNode> nodes(source.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
        nodes[i].name = source[i].name.empty() ? "node_" + std::to_string(i) : source[i].name;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const int child : source[i].children) {
            if (child < 0 || static_cast<std::size_t>(child) >= nodes.size())
                throw InputError(document.file + ": " + node_words(nodes, i) + " has a child " +
                                 std::to_string(child) + ", which does not exist");
            std::int32_t& parent = nodes[static_cast<std::size_t>(child)].parent;
            if (parent >= 0)
                throw InputError(document.file + ": " + node_words(nodes, static_cast<std::size_t>(child)) +
                                 " has two parents");
            parent = static_cast<std::int32_t>(i);
        }
    // With one parent each, whatever no root leads to runs in a circle.
    std::vector<std::size_t> reached;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].parent < 0) reached.push_back(i);
    std::vector<bool> seen(nodes.size(), false);
    for (std::size_t k = 0; k < reached.size(); ++k) {
        seen[reached[k]] = true;
        for (const int child : source[reached[k]].children)
            reached.push_back(static_cast<std::size_t>(child));
    }
    const auto lost = std::find(seen.begin(), seen.end(), false);
    if (lost != seen.end())
        throw InputError(document.file + ": " +
                         node_words(nodes, static_cast<std::size_t>(lost - seen.begin())) +
                         " is its own ancestor: the node graph has a cycle");
    return nodes;
}

std::vector<SceneInstance> gltf_instances(const GltfDocument& document, const std::vector<SceneNode>& nodes,
                                          std::vector<SceneCamera>* cameras) {
    struct Visit {
        std::size_t node;
        glm::dmat4 parent;
    };
    std::vector<Visit> stack;
    const std::vector<std::size_t> roots = roots_to_draw(document, nodes);
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, glm::dmat4(1)});
    std::vector<SceneInstance> instances;
    std::vector<bool> seen(nodes.size(), false);
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        if (seen[visit.node])
            throw InputError(document.file + ": the scene reaches " + node_words(nodes, visit.node) +
                             " twice");
        seen[visit.node] = true;
        const tinygltf::Node& node = document.model.nodes[visit.node];
        const glm::dmat4 world = visit.parent * local_transform(document, nodes, visit.node);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
            stack.push_back({static_cast<std::size_t>(*child), world});
        if (cameras && node.camera >= 0)
            cameras->push_back(placed_camera(document, node_words(nodes, visit.node), node.camera, world));
        if (node.mesh < 0) continue;
        if (static_cast<std::size_t>(node.mesh) >= document.model.meshes.size())
            throw InputError(document.file + ": " + node_words(nodes, visit.node) + " has mesh " +
                             std::to_string(node.mesh) + ", which does not exist");

        const auto add = [&](const glm::dmat4& transform, std::int32_t gpu_instance) {
            SceneInstance& instance = instances.emplace_back();
            instance.mesh = static_cast<std::uint32_t>(node.mesh);
            instance.transform = glm::mat4(transform);
            instance.name = nodes[visit.node].name;
            instance.source_node = static_cast<std::int32_t>(visit.node);
            instance.gpu_instance = gpu_instance;
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    if (!std::isfinite(instance.transform[column][row]))
                        throw InputError(document.file + ": " + node_words(nodes, visit.node) +
                                         " has a transform that is not finite");
            for (int column = 0; column < 4; ++column)
                instance.transform[column][3] = column == 3 ? 1.0f : 0.0f;
        };
        const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
        if (extension == node.extensions.end()) {
            add(world, -1);
            continue;
        }
        const std::vector<glm::dmat4> transforms = gpu_instances(
            document, extension->second, node_words(nodes, visit.node) + ": EXT_mesh_gpu_instancing: ");
        for (std::size_t i = 0; i < transforms.size(); ++i)
            add(world * transforms[i], static_cast<std::int32_t>(i));
    }
    return instances;
}

}  // namespace dfield
