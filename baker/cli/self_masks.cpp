#include "baker/cli/self_masks.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/cli/terminal.hpp"
#include "baker/parallel.hpp"
#include "baker/ray_visibility.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::cli {
namespace {

std::size_t nearest(std::span<const glm::vec3> directions, const glm::vec3& wanted) {
    std::size_t best = 0;
    float cosine = -2;
    for (std::size_t i = 0; i < directions.size(); ++i)
        if (const float c = glm::dot(directions[i], wanted); c > cosine) cosine = c, best = i;
    return best;
}

}  // namespace

SelfMasks::SelfMasks(const TriangleMesh& mesh, std::size_t instances, int threads)
    : mesh_(mesh), instances_(instances), threads_(threads), origins_(vertex_ray_origins(mesh)) {
    scene_.add_mesh(mesh);
    scene_.commit(threads);
}

std::vector<std::uint32_t> SelfMasks::cast(std::span<const glm::vec3> directions) const {
    RayVisibilityOptions options;
    options.directions = directions;
    options.shared = true;
    options.threads = threads_;
    options.cancel = &interrupted;
    return ray_masks(scene_, origins_, mesh_.normals, options);
}

std::vector<std::uint32_t> SelfMasks::of_instance(const glm::mat4& object_to_world,
                                                  std::span<const glm::vec3> directions) {
    // Which side of its tangent plane a vertex looks to, and what it meets there, no transform changes.
    const glm::mat3 to_object = glm::inverse(glm::mat3(object_to_world));
    std::vector<glm::vec3> carried;
    for (const glm::vec3& direction : directions) carried.push_back(glm::normalize(to_object * direction));
    if (instances_ * directions.size() <= kObjectDirections) return cast(carried);

    if (object_directions_.empty()) {
        object_directions_ = fibonacci_sphere(kObjectDirections);
        object_masks_ = cast(object_directions_);
    }
    std::vector<std::size_t> source;
    for (const glm::vec3& direction : carried) source.push_back(nearest(object_directions_, direction));
    const std::size_t words = (directions.size() + 31) / 32, object_words = kObjectDirections / 32;
    std::vector<std::uint32_t> masks(origins_.size() * words);
    parallel_ranges(threads_, origins_.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t r = 0; r < source.size(); ++r) {
                const std::uint32_t word = object_masks_[i * object_words + source[r] / 32];
                masks[i * words + r / 32] |= (word >> (source[r] % 32) & 1) << (r % 32);
            }
    });
    return masks;
}

}  // namespace dfield::cli
