#include "baker/cli/accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "baker/cli/corner.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/ray_visibility.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::cli {

Json Accuracy::json() const {
    return {{"rms_grey", significant(rms_grey, 4)},
            {"bias_grey", significant(bias_grey, 4)},
            {"max_grey", significant(max_grey, 4)},
            {"rms_grey_converged", significant(rms_grey_converged, 4)}};
}

AccuracyScene::AccuracyScene(const TriangleMesh& mesh, float gap, int threads)
    : receivers_(placed_vertices(corner_room(triangle_bounds(mesh), gap), glm::mat4(1))),
      directions_(fibonacci_sphere(kAccuracyDirections)) {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(mesh);
    scene.commit(threads);
    RayVisibilityOptions options;
    options.threads = threads;
    options.cancel = &interrupted;
    options.directions = directions_;
    options.shared = true;
    same_rays_ = ray_visibility(scene, receivers_.positions, receivers_.normals, options);
    const std::vector<glm::vec3> many = cosine_directions(kConvergedRays);
    options.directions = many;
    options.shared = false;
    converged_ = ray_visibility(scene, receivers_.positions, receivers_.normals, options);
}

Accuracy AccuracyScene::measure(const Context& context, const Field& field, dfield_kind kind) const {
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = DFIELD_SAMPLING_SHARED;
    desc.kind = kind;
    desc.ray_count = static_cast<std::uint32_t>(directions_.size());
    desc.directions = &directions_.front().x;
    const Ao ao(context, desc);
    Scene scene(context);
    scene.add(field, &glm::mat4(1)[0][0]);
    std::vector<float> looked_up(receivers_.size());
    scene.visibility(ao, receivers_.view(), looked_up.data());

    Accuracy result;
    double squares = 0, sum = 0, squares_converged = 0;
    for (std::size_t i = 0; i < looked_up.size(); ++i) {
        const double error = 255.0 * (static_cast<double>(looked_up[i]) - same_rays_[i]);
        squares += error * error;
        sum += error;
        result.max_grey = std::max(result.max_grey, std::fabs(error));
        squares_converged += std::pow(255.0 * (static_cast<double>(looked_up[i]) - converged_[i]), 2);
    }
    const auto count = static_cast<double>(looked_up.size());
    result.rms_grey = std::sqrt(squares / count);
    result.bias_grey = sum / count;
    result.rms_grey_converged = std::sqrt(squares_converged / count);
    return result;
}

}  // namespace dfield::cli
