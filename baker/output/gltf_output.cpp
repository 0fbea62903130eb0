#include "baker/output/gltf_output.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "baker/import/gltf_accessor.hpp"
#include "baker/import/gltf_instancing.hpp"
#include "baker/output/gltf_patch.hpp"
#include "baker/output/occlusion_values.hpp"

namespace dfield {
namespace {

// The occlusion attributes of one instance in its own entry of "meshes".
class MeshPatcher {
  public:
    MeshPatcher(GltfPatch& document, const SceneMesh& mesh, std::span<const float> visibility, bool color)
        : document_(document), mesh_(mesh), visibility_(visibility), color_(color) {}

    void patch(std::size_t mesh_index) {
        std::map<std::size_t, std::vector<const PrimitiveRange*>> groups;  // by POSITION accessor
        for (const PrimitiveRange& range : mesh_.primitives) {
            const auto position = document_.index_in(attributes(mesh_index, range), "POSITION");
            if (!position) changed();
            const Json& accessor = document_.entry("accessors", *position);
            if (document_.index_in(accessor, "count") != range.vertex_count) changed();
            groups[*position].push_back(&range);
        }
        for (const auto& [position, ranges] : groups)
            if (const auto shared = shared_values(ranges))
                attach(mesh_index, ranges, *shared);
            else
                for (const PrimitiveRange* range : ranges) attach(mesh_index, {range}, values_of(*range));
        open_the_rest(mesh_index);
    }

  private:
    [[noreturn]] void changed() const {
        document_.fail("mesh \"" + mesh_.name +
                       "\" is not what was read before; was the file written meanwhile?");
    }

    Json& attributes(std::size_t mesh_index, const PrimitiveRange& range) {
        Json& mesh = document_.entry("meshes", mesh_index);
        if (!mesh.contains("primitives") || range.primitive >= mesh["primitives"].size()) changed();
        return mesh["primitives"][range.primitive].at("attributes");
    }

    std::span<const float> values_of(const PrimitiveRange& range) const {
        return visibility_.subspan(range.first_vertex, range.vertex_count);
    }

    // One array for primitives that share their positions: each vertex has the value of the primitive whose
    // triangles use it. Nothing where two of them use a vertex and disagree (it has two normals).
    std::optional<std::vector<float>> shared_values(const std::vector<const PrimitiveRange*>& ranges) const {
        const auto first = values_of(*ranges.front());
        std::vector<float> values(first.begin(), first.end());
        std::vector<char> used(values.size(), 0);
        for (const PrimitiveRange* range : ranges) {
            if (ranges.size() == 1) break;
            const auto own = values_of(*range);
            for (std::uint32_t t = 0; t < range->triangle_count; ++t)
                for (int corner = 0; corner < 3; ++corner) {
                    const std::uint32_t vertex =
                        mesh_.mesh.triangles[range->first_triangle + t][corner] - range->first_vertex;
                    if (used[vertex] && values[vertex] != own[vertex]) return std::nullopt;
                    values[vertex] = own[vertex];
                    used[vertex] = 1;
                }
        }
        return values;
    }

    void attach(std::size_t mesh_index, const std::vector<const PrimitiveRange*>& ranges,
                std::span<const float> values) {
        const std::size_t occlusion = document_.append_accessor(std::as_bytes(values), kGltfFloat, "SCALAR",
                                                                values.size(), kGltfArrayBuffer);
        std::map<std::optional<std::size_t>, std::size_t> colors;  // by the COLOR_0 they had
        for (const PrimitiveRange* range : ranges) {
            Json& target = attributes(mesh_index, *range);
            target["_OCCLUSION"] = occlusion;
            if (!color_) continue;
            const auto existing = document_.index_in(target, "COLOR_0");
            auto [color, is_new] = colors.try_emplace(existing);
            if (is_new) color->second = append_color(existing, values);
            target["COLOR_0"] = color->second;
        }
    }

    // Points and lines have no hemisphere to see: they are open, so that a mesh has the attribute throughout.
    void open_the_rest(std::size_t mesh_index) {
        const std::size_t count = document_.entry("meshes", mesh_index).at("primitives").size();
        for (std::size_t primitive = 0; primitive < count; ++primitive) {
            const auto is_it = [&](const PrimitiveRange& range) { return range.primitive == primitive; };
            if (std::any_of(mesh_.primitives.begin(), mesh_.primitives.end(), is_it)) continue;
            const PrimitiveRange rest{.primitive = static_cast<std::uint32_t>(primitive)};
            const auto position = document_.index_in(attributes(mesh_index, rest), "POSITION");
            if (!position) continue;
            const auto vertices = document_.index_in(document_.entry("accessors", *position), "count");
            const std::vector<float> open(vertices.value_or(0), 1.0f);
            if (!open.empty())
                attributes(mesh_index, rest)["_OCCLUSION"] = document_.append_accessor(
                    std::as_bytes(std::span(open)), kGltfFloat, "SCALAR", open.size(), kGltfArrayBuffer);
        }
    }

    std::size_t append_color(std::optional<std::size_t> existing, std::span<const float> values) {
        if (!existing) return append_grey_colors(document_, values);
        const std::string name = "COLOR_0 of mesh \"" + mesh_.name + "\"";
        const auto index = static_cast<int>(*existing);
        if (accessor_count(document_.original(), index, name) != values.size())
            document_.fail(name + " does not fit its positions; export the file again");
        const int type = document_.original().model.accessors[*existing].type;
        const int components = type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
        const std::vector<float> old = read_accessor(document_.original(), index, components, name);
        std::vector<float> colors;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const float* from = &old[i * static_cast<std::size_t>(components)];
            const float alpha = components == 4 ? from[3] : 1.0f;
            colors.insert(colors.end(),
                          {from[0] * values[i], from[1] * values[i], from[2] * values[i], alpha});
        }
        return append_colors(document_, colors);
    }

    GltfPatch& document_;
    const SceneMesh& mesh_;
    std::span<const float> visibility_;
    bool color_;
};

bool is_gpu_instanced(const Json& node) {
    const auto extensions = node.find("extensions");
    return extensions != node.end() && extensions->contains("EXT_mesh_gpu_instancing");
}

// The node that shows each instance once instancing by extension is expanded.
std::vector<std::size_t> nodes_of_instances(GltfPatch& document, const ImportedScene& scene) {
    std::map<std::size_t, std::vector<std::size_t>> expanded;
    std::vector<std::size_t> nodes;
    for (const SceneInstance& instance : scene.instances) {
        auto node = static_cast<std::size_t>(instance.source_node);
        if (instance.gpu_instance >= 0) {
            auto [children, is_new] = expanded.try_emplace(node);
            if (is_new) {
                if (!is_gpu_instanced(document.entry("nodes", node)))
                    document.fail("node " + std::to_string(node) +
                                  " has no instances any more; was the file changed?");
                children->second = expand_gpu_instances(document, node);
            }
            if (static_cast<std::size_t>(instance.gpu_instance) >= children->second.size())
                document.fail("node " + std::to_string(node) +
                              " has fewer instances than before; was the file changed?");
            node = children->second[static_cast<std::size_t>(instance.gpu_instance)];
        }
        nodes.push_back(node);
    }
    if (!expanded.empty()) forget_unused_gpu_instancing(document);
    return nodes;
}

void add_occlusion(GltfPatch& document, const ImportedScene& scene,
                   std::span<const std::vector<float>> visibility, const OcclusionOutputOptions& options) {
    const std::vector<std::size_t> nodes = nodes_of_instances(document, scene);
    std::map<std::size_t, std::size_t> uses;  // of each mesh, by all nodes, also those outside the scene
    for (const Json& node : document.json.at("nodes"))
        if (const auto mesh = document.index_in(node, "mesh")) ++uses[*mesh];
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const SceneMesh& mesh = scene.meshes[scene.instances[i].mesh];
        const auto source = static_cast<std::size_t>(mesh.source_mesh);
        Json& node = document.entry("nodes", nodes[i]);
        if (document.index_in(node, "mesh") != source)
            document.fail("node " + std::to_string(nodes[i]) +
                          " does not show the mesh it did; was the file changed?");
        std::size_t target = source;
        // All but the mesh's last user get a copy, made while the entry is still as it was.
        if (--uses[source] > 0) {
            Json copy = document.entry("meshes", source);
            target = document.append("meshes", std::move(copy));
            node["mesh"] = target;
        }
        MeshPatcher(document, mesh, visibility[i], options.color).patch(target);
    }
}

}  // namespace

void write_gltf_occlusion(const std::filesystem::path& input, const std::filesystem::path& output,
                          const ImportedScene& scene, std::span<const std::vector<float>> visibility,
                          const OcclusionOutputOptions& options) {
    check_visibility(scene, visibility);
    for (const SceneInstance& instance : scene.instances)
        if (instance.source_node < 0 || scene.meshes[instance.mesh].source_mesh < 0)
            throw std::invalid_argument("write_gltf_occlusion: the scene does not come from a glTF file");
    GltfPatch document(input);
    try {
        add_occlusion(document, scene, visibility, options);
    } catch (const Json::exception& error) {
        document.fail(std::string("malformed glTF: ") + error.what());
    }
    document.write(output);
}

}  // namespace dfield
