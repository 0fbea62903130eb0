#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <array>
#include <map>
#include <sstream>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/import/import_formats.hpp"
#include "baker/import/openmesh_input.hpp"
#include "baker/import/openmesh_log.hpp"
#include "baker/import/polygon_soup.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {
namespace {

using OpenMesh::VertexHandle;

glm::vec3 to_glm(const OpenMesh::Vec3f& v) {
    return {v[0], v[1], v[2]};
}

// Collects what a reader delivers, every face as it comes: no half-edges, so nothing is refused or
// duplicated.
class SoupImporter final : public OpenMesh::IO::BaseImporter {
  public:
    // Normals come before the face that they belong to (OBJ: one per corner) or with the vertices (PLY, OFF).
    explicit SoupImporter(bool corner_normals) : corner_normals_(corner_normals) {}

    std::vector<glm::vec3> positions, normals;     // normals: per vertex, empty or as many as positions
    std::vector<std::uint32_t> corners, face_end;  // face i has corners face_end[i - 1] .. face_end[i]
    std::vector<glm::vec3> normals_of_corners;     // per corner, (0,0,0) where the file has none

    VertexHandle add_vertex(const OpenMesh::Vec3f& point) override {
        positions.push_back(to_glm(point));
        return VertexHandle(static_cast<int>(positions.size() - 1));
    }
    VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3f(0, 0, 0)); }
    void set_point(VertexHandle vertex, const OpenMesh::Vec3f& point) override {
        if (const std::size_t i = index(vertex); i < positions.size()) positions[i] = to_glm(point);
    }
    void set_normal(VertexHandle vertex, const OpenMesh::Vec3f& normal) override {
        if (corner_normals_) {
            pending_.emplace_back(vertex, to_glm(normal));
        } else if (const std::size_t i = index(vertex); i < positions.size()) {
            normals.resize(positions.size(), glm::vec3(0));
            normals[i] = to_glm(normal);
        }
    }
    void set_normal(VertexHandle vertex, const OpenMesh::Vec3d& normal) override {
        set_normal(vertex, OpenMesh::Vec3f(normal));
    }
    OpenMesh::FaceHandle add_face(const VHandles& vertices) override {
        std::size_t next = 0;  // pending normals come in the order of the corners that have one
        for (const VertexHandle vertex : vertices) {
            corners.push_back(static_cast<std::uint32_t>(vertex.idx()));
            if (!corner_normals_) continue;
            const bool has_normal = next < pending_.size() && pending_[next].first == vertex;
            normals_of_corners.push_back(has_normal ? pending_[next++].second : glm::vec3(0));
        }
        pending_.clear();
        face_end.push_back(static_cast<std::uint32_t>(corners.size()));
        return OpenMesh::FaceHandle(static_cast<int>(face_end.size() - 1));
    }
    size_t n_vertices() const override { return positions.size(); }
    size_t n_faces() const override { return face_end.size(); }
    size_t n_edges() const override { return 0; }

    // The rest of the interface: colours, texture coordinates, half-edges, status. None of it is asked for.
    OpenMesh::HalfedgeHandle add_edge(VertexHandle, VertexHandle) override {
        return OpenMesh::HalfedgeHandle();
    }
    OpenMesh::FaceHandle add_face(OpenMesh::HalfedgeHandle) override { return OpenMesh::FaceHandle(); }
    void add_face_texcoords(OpenMesh::FaceHandle, VertexHandle,
                            const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(OpenMesh::FaceHandle, VertexHandle,
                            const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(OpenMesh::FaceHandle, int) override {}
    void set_halfedge(VertexHandle, OpenMesh::HalfedgeHandle) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4f&) override {}
    void set_texcoord(VertexHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec3f&) override {}
    void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(OpenMesh::HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(OpenMesh::FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_next(OpenMesh::HalfedgeHandle, OpenMesh::HalfedgeHandle) override {}
    void set_face(OpenMesh::HalfedgeHandle, OpenMesh::FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3d&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4f&) override {}
    void add_texture_information(int, std::string) override {}

  private:
    static std::size_t index(VertexHandle vertex) { return static_cast<std::uint32_t>(vertex.idx()); }

    bool corner_normals_;
    std::vector<std::pair<VertexHandle, glm::vec3>> pending_;
};

// OBJ gives normals to corners; a vertex whose corners disagree is split, its first normal keeps the vertex.
void split_by_normals(SoupImporter& soup) {
    const std::size_t original = soup.positions.size();
    std::vector<bool> taken(original, false);
    std::map<std::pair<std::uint32_t, std::array<float, 3>>, std::uint32_t> copies;
    bool any = false;
    for (const glm::vec3& n : soup.normals_of_corners) any = any || n != glm::vec3(0);
    if (!any) return;
    soup.normals.assign(original, glm::vec3(0));
    for (std::size_t c = 0; c < soup.corners.size(); ++c) {
        std::uint32_t& vertex = soup.corners[c];
        const glm::vec3& normal = soup.normals_of_corners[c];
        if (vertex >= original || !usable_position(normal) || normal == glm::vec3(0)) continue;
        if (!taken[vertex]) {
            taken[vertex] = true;
            soup.normals[vertex] = normal;
        } else if (soup.normals[vertex] != normal) {
            const std::array<float, 3> key = {normal.x, normal.y, normal.z};
            const auto [copy, is_new] =
                copies.try_emplace({vertex, key}, static_cast<std::uint32_t>(soup.positions.size()));
            if (is_new) {
                soup.positions.push_back(glm::vec3(soup.positions[vertex]));
                soup.normals.push_back(normal);
            }
            vertex = copy->second;
        }
    }
}

OpenMeshInput reduce(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string file = path.string(), extension = path.extension().string();
    if (equal_ignoring_case(extension, ".obj")) return reduce_obj(file, text);
    if (equal_ignoring_case(extension, ".ply")) return reduce_ply(file, text);
    if (equal_ignoring_case(extension, ".off")) return reduce_off(file, text);
    return reduce_stl(file, text);
}

// Fills `soup`; returns what OpenMesh had to say.
std::vector<std::string> read(const std::string& file, OpenMeshInput& input, SoupImporter& soup) {
    const OpenMeshLog log;
    // Naming the readers registers them with IOManager also where a linker drops objects that nobody names.
    OpenMesh::IO::OBJReader(), OpenMesh::IO::PLYReader(), OpenMesh::IO::STLReader();
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    if (input.binary) options += OpenMesh::IO::Options::Binary;
    std::istringstream stream(std::move(input.bytes), std::ios::in | std::ios::binary);
    const bool read = OpenMesh::IO::IOManager().read(stream, input.extension, soup, options);
    std::vector<std::string> lines = log.lines();
    const bool complete = soup.face_end.size() == input.faces && soup.positions.size() == input.vertices;
    if (!read || (!complete && !input.welded))
        throw InputError(file + ": OpenMesh could not read it (" + std::to_string(soup.positions.size()) +
                         " of " + std::to_string(input.vertices) + " vertices, " +
                         std::to_string(soup.face_end.size()) + " of " + std::to_string(input.faces) +
                         " faces)" + (lines.empty() ? "" : ": " + lines[0]));
    return lines;
}

}  // namespace

ImportedScene import_openmesh(const std::filesystem::path& path, const ImportOptions& options) {
    const std::string file = path.string();
    OpenMeshInput input = reduce(path);
    if (input.vertices > 0x7fffffff || input.faces > 0x7fffffff)
        throw InputError(file + ": more than 2^31 - 1 vertices or faces");
    SoupImporter soup(input.extension == "obj");
    ImportedScene scene;
    for (const std::string& line : read(file, input, soup))
        scene.report.warnings.push_back("OpenMesh: " + line);
    if (input.extension == "obj") split_by_normals(soup);

    SceneMesh& mesh = scene.meshes.emplace_back();
    mesh.name = path.stem().string();
    mesh.mesh.positions = std::move(soup.positions);
    mesh.mesh.normals = std::move(soup.normals);
    std::uint32_t begin = 0;
    for (const std::uint32_t end : soup.face_end) {
        add_face(mesh.mesh, scene.report, std::span(soup.corners).subspan(begin, end - begin), file);
        begin = end;
    }
    for (const std::vector<std::uint32_t>& face : input.other_faces)
        add_face(mesh.mesh, scene.report, face, file);
    if (input.welded) {
        const std::uint64_t collapsed = input.faces - soup.face_end.size();
        scene.report.faces += collapsed;
        scene.report.degenerate += collapsed;
    }
    scene.report.skipped_primitives = input.skipped;
    finish_mesh(mesh.mesh, options.crease_degrees);
    scene.instances.push_back({0, glm::mat4(1), mesh.name, -1, -1});
    return scene;
}

}  // namespace dfield
