#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/error.hpp"
#include "baker/import/gltf_accessor.hpp"
#include "baker/import/gltf_document.hpp"
#include "baker/import/gltf_nodes.hpp"
#include "baker/import/import_formats.hpp"
#include "baker/import/polygon_soup.hpp"

namespace dfield {
namespace {

// A primitive's vertices end up behind those of the primitives before it.
class MeshImporter {
  public:
    MeshImporter(const GltfDocument& document, ImportReport& report, bool looks)
        : document_(document), report_(report), looks_(looks) {}

    SceneMesh import(std::size_t index) {
        const tinygltf::Mesh& source = document_.model.meshes[index];
        SceneMesh mesh;
        mesh.name = source.name.empty() ? "mesh_" + std::to_string(index) : source.name;
        mesh.source_mesh = static_cast<std::int32_t>(index);
        for (std::size_t p = 0; p < source.primitives.size(); ++p) {
            where_ = "primitive " + std::to_string(p) + " of mesh " + std::to_string(index) + " ('" +
                     mesh.name + "')";
            primitive(mesh, source.primitives[p], static_cast<std::uint32_t>(p));
        }
        finish_mesh(mesh.mesh, 180.0f);  // a split vertex would have no place in the file
        return mesh;
    }

  private:
    void primitive(SceneMesh& mesh, const tinygltf::Primitive& source, std::uint32_t index) {
        constexpr int kFirstTriangleMode = TINYGLTF_MODE_TRIANGLES,
                      kLastTriangleMode = TINYGLTF_MODE_TRIANGLE_FAN;
        if (source.mode < TINYGLTF_MODE_POINTS || source.mode > kLastTriangleMode)
            throw InputError(document_.file + ": " + where_ + " has an unknown mode " +
                             std::to_string(source.mode));
        const auto position = source.attributes.find("POSITION");
        if (source.mode < kFirstTriangleMode || position == source.attributes.end()) {
            ++report_.skipped_primitives;
            if (source.mode >= kFirstTriangleMode) warn("has no POSITION and is left out");
            return;
        }
        if (!source.targets.empty()) warn("has morph targets, which are not applied");

        PrimitiveRange range;
        range.primitive = index;
        range.first_vertex = static_cast<std::uint32_t>(mesh.mesh.positions.size());
        range.first_triangle = static_cast<std::uint32_t>(mesh.mesh.triangles.size());
        const std::vector<float> numbers =
            read_accessor(document_, position->second, 3, "POSITION of " + where_);
        const std::size_t count = numbers.size() / 3;
        if (mesh.mesh.positions.size() + count > 0x7fffffff)
            throw InputError(document_.file + ": " + where_ + ": the mesh has more than 2^31 - 1 vertices");
        range.vertex_count = static_cast<std::uint32_t>(count);
        for (std::size_t i = 0; i < count; ++i)
            mesh.mesh.positions.emplace_back(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
        normals(mesh.mesh, source, range);
        if (looks_) albedo(mesh.albedo, source, count);

        std::vector<std::uint32_t> indices;
        if (source.indices >= 0) {
            indices = read_index_accessor(document_, source.indices, "indices of " + where_);
        } else {
            indices.resize(count);
            std::iota(indices.begin(), indices.end(), 0u);
        }
        triangles(mesh.mesh, source.mode, indices, range);
        range.triangle_count = static_cast<std::uint32_t>(mesh.mesh.triangles.size()) - range.first_triangle;
        mesh.primitives.push_back(range);
    }

    // Missing normals become 0 here: finish_mesh computes them.
    void normals(TriangleMesh& mesh, const tinygltf::Primitive& source, const PrimitiveRange& range) {
        const auto normal = source.attributes.find("NORMAL");
        if (normal == source.attributes.end() && mesh.normals.empty()) return;
        mesh.normals.resize(mesh.positions.size(), glm::vec3(0));
        if (normal == source.attributes.end()) return;
        const std::vector<float> numbers = read_accessor(document_, normal->second, 3, "NORMAL of " + where_);
        if (numbers.size() != 3 * std::size_t{range.vertex_count})
            throw InputError(document_.file + ": " + where_ + " has " + std::to_string(range.vertex_count) +
                             " positions and " + std::to_string(numbers.size() / 3) + " normals");
        for (std::size_t i = 0; i < range.vertex_count; ++i)
            mesh.normals[range.first_vertex + i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    }

    // The material's base colour times the vertices' own.
    void albedo(std::vector<glm::vec3>& albedo, const tinygltf::Primitive& source, std::size_t count) {
        const std::vector<GltfMaterial>& materials = document_.looks.materials;
        glm::vec3 base(1);  // glTF's default material
        if (source.material >= 0) {
            if (static_cast<std::size_t>(source.material) >= materials.size())
                throw InputError(document_.file + ": " + where_ + " has material " +
                                 std::to_string(source.material) + ", which does not exist");
            const GltfMaterial& material = materials[static_cast<std::size_t>(source.material)];
            base = material.base_colour;
            if (material.textured) warn("has a base colour texture, which is not read");
        }
        albedo.resize(albedo.size() + count, base);
        const auto colour = source.attributes.find("COLOR_0");
        if (colour == source.attributes.end()) return;
        const std::string what = "COLOR_0 of " + where_;
        const int components = accessor_components(document_, colour->second, what);
        if (components != 3 && components != 4)
            throw InputError(document_.file + ": " + what + " should have 3 or 4 components");
        const std::vector<float> numbers = read_accessor(document_, colour->second, components, what);
        if (numbers.size() != count * static_cast<std::size_t>(components))
            throw InputError(
                document_.file + ": " + where_ + " has " + std::to_string(count) + " positions and " +
                std::to_string(numbers.size() / static_cast<std::size_t>(components)) + " colours");
        for (std::size_t i = 0; i < count; ++i) {
            const float* rgb = &numbers[i * static_cast<std::size_t>(components)];
            glm::vec3& value = albedo[albedo.size() - count + i];
            for (int c = 0; c < 3; ++c)
                value[c] *= std::isfinite(rgb[c]) ? std::clamp(rgb[c], 0.0f, 1.0f) : 1;
        }
    }

    void triangles(TriangleMesh& mesh, int mode, const std::vector<std::uint32_t>& indices,
                   const PrimitiveRange& range) {
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            std::uint32_t corners[3] = {indices[a], indices[b], indices[c]};
            for (std::uint32_t& corner :
                 corners)  // beyond the primitive is out of range, also inside the mesh
                corner = corner < range.vertex_count ? corner + range.first_vertex : ~0u;
            add_face(mesh, report_, corners, document_.file);
        };
        const std::size_t n = indices.size();
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            for (std::size_t i = 0; i + 2 < n; i += 3) add(i, i + 1, i + 2);
            if (n % 3 != 0) warn("has " + std::to_string(n % 3) + " indices behind its last triangle");
        } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            for (std::size_t i = 0; i + 2 < n; ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
        } else {
            for (std::size_t i = 0; i + 2 < n; ++i) add(i + 1, i + 2, 0);
        }
    }

    void warn(const std::string& message) { report_.warnings.push_back(where_ + " " + message); }

    const GltfDocument& document_;
    ImportReport& report_;
    std::string where_;
    bool looks_;
};

}  // namespace

ImportedScene import_gltf(const std::filesystem::path& path, const ImportOptions& options) {
    GltfDocument document = load_gltf_document(path, options.looks);
    ImportedScene scene;
    scene.report.warnings = std::move(document.warnings);
    scene.nodes = gltf_nodes(document);
    MeshImporter importer(document, scene.report, options.looks);
    for (std::size_t i = 0; i < document.model.meshes.size(); ++i) scene.meshes.push_back(importer.import(i));
    scene.instances = gltf_instances(document, scene.nodes, options.looks ? &scene.cameras : nullptr);
    for (const SceneInstance& instance : scene.instances)
        if (document.model.nodes[static_cast<std::size_t>(instance.source_node)].skin >= 0 &&
            instance.gpu_instance <= 0)
            scene.report.warnings.push_back("node '" + instance.name +
                                            "' has a skin, which is not applied: it is " +
                                            "taken as modelled, where its node stands");
    return scene;
}

}  // namespace dfield
