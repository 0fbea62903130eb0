// Non-uniform and mirrored scale: the error beside the unscaled instance's.
#include <algorithm>
#include <glm/ext/matrix_transform.hpp>

#include "baker/cli/corner.hpp"
#include "bench/kinds/contest.hpp"
#include "bench/kinds/report.hpp"
#include "bench/kinds/specimens.hpp"
#include "bench/paper/measure.hpp"

namespace dfield::kinds {
namespace {

TriangleMesh placed(const TriangleMesh& mesh, const glm::mat4& transform) {
    TriangleMesh result;
    result.triangles = mesh.triangles;
    for (const glm::vec3& position : mesh.positions)
        result.positions.emplace_back(transform * glm::vec4(position, 1));
    return result;
}

double error_of(const TriangleMesh& mesh, std::span<const std::byte> bytes, const Specimen& specimen,
                const Pairs& pairs, const glm::mat4& transform) {
    const TriangleMesh moved = placed(mesh, transform);
    const paper::Receivers receivers =
        cli::placed_vertices(cli::corner_room(triangle_bounds(moved), 0.1f), glm::mat4(1));
    EmbreeScene embree(EmbreeUse::kFast);
    embree.add_mesh(moved);
    embree.commit();
    const EmbreeContest reference(embree, receivers, pairs, false);

    const Context context;
    const Field field = Field::load(context, bytes.data(), bytes.size());
    const Ao ao(context, pairs.desc(specimen.forced));
    Scene scene(context);
    scene.add(field, &transform[0][0]);
    std::vector<float> visibility(receivers.size());
    scene.visibility(ao, receivers.view(), visibility.data());
    return paper::errors_of(visibility, reference.visibility()).rms;
}

}  // namespace

void measure_scales(paper::Lab& lab, Report& report) {
    say_progress("scales");
    const paper::Model& model = lab.subject();
    const glm::mat4 turned = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 0.5f)));
    const glm::mat4 non_uniform = turned * glm::scale(glm::mat4(1), glm::vec3(1, 1.6f, 0.6f));
    const glm::mat4 mirrored = turned * glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1));
    const Pairs hemisphere = hemisphere_pairs(lab), shared = shared_pairs(lab);
    double worst_non_uniform = 0, worst_mirrored = 0;
    for (const Specimen& specimen : specimens(lab, false)) {
        const std::vector<std::byte> bytes = baked_specimen(model.mesh, specimen);
        const auto error = [&](const glm::mat4& transform) {
            return error_of(model.mesh, bytes, specimen, specimen.shared() ? shared : hemisphere, transform);
        };
        const ScaleRow row{specimen.kind + ", " + specimen.size, error(turned), error(non_uniform),
                           error(mirrored)};
        report.scales.push_back(row);
        if (specimen.forced == DFIELD_KIND_VOLUME) continue;  // what is asked is asked of the others
        worst_non_uniform = std::max(worst_non_uniform, row.non_uniform / row.plain);
        worst_mirrored = std::max(worst_mirrored, row.mirrored / row.plain);
    }
    if (model.name != "bunny") return;
    report.measured[Figure::kNonUniformScale] = worst_non_uniform;
    report.measured[Figure::kMirroredScale] = worst_mirrored;
}

}  // namespace dfield::kinds
