// The improved form by the reference's sweeps, and what is the same in all forms of it.
#include <algorithm>
#include <cmath>

#include "volume/buffer.hpp"
#include "volume/field.hpp"
#include "volume/occlusion.hpp"
#include "volume/reference.hpp"

namespace dfield::runtime::volume {

std::array<Ordinate, kMaxOrdinates> ordinates_of(std::size_t octant, std::size_t count) {
    if (count == 1) return {{{1.0f / 3, 1.0f / 3, 1.0f / 3}}};
    constexpr float a = 0.55f, b = 0.3f, c = 0.15f;
    std::array<Ordinate, kMaxOrdinates> result{
        {{a, b, c}, {c, a, b}, {b, c, a}, {a, c, b}, {b, a, c}, {c, b, a}}};
    const Sweep& sweep = kSweeps[octant];
    if (count == 3 && sweep.x * sweep.y * sweep.z < 0)
        std::rotate(result.begin(), result.begin() + 3, result.end());
    return result;
}

Ordinate weights_of(const Ordinate& direction, const Grid& grid) {
    const Ordinate per{direction.x / grid.hx, direction.y / grid.hy, direction.z / grid.hz};
    const float sum = per.x + per.y + per.z;
    return {per.x / sum, per.y / sum, per.z / sum};
}

namespace {

// The last mend: `swept`, a visibility with the gradient as normal, taken where each voxel near the surface
// lies when moved along its normal until it is kImprovedOffset h off the surface. Here h is the spacing along
// the normal: trilinear results reach from one voxel to the next.
void move_off_surface(const Grid& grid, const float* distance, const float* swept, float* result) {
    const SignedField field{grid, distance}, visibility{grid, swept};
    const glm::vec3 spacing(grid.hx, grid.hy, grid.hz);
    for (std::size_t z = 0, i = 0; z < grid.nz; ++z)
        for (std::size_t y = 0; y < grid.ny; ++y)
            for (std::size_t x = 0; x < grid.nx; ++x, ++i) {
                result[i] = swept[i];
                const glm::vec3 gradient = field.gradient(x, y, z);
                const float length = glm::length(gradient);
                if (!(length > 0)) continue;
                const float h = length / glm::length(gradient / spacing);
                if (distance[i] < -kImprovedDepth * h || distance[i] >= kImprovedOffset * h) continue;
                const glm::vec3 point = glm::vec3(x, y, z) * spacing;
                result[i] = visibility.at(point + (kImprovedOffset * h - distance[i]) / length * gradient);
            }
}

std::vector<float> transmittances(const OcclusionJob& job) {
    const Grid& grid = job.grid;
    const SignedField field{grid, job.distance};
    std::vector<float> result(grid.size());
    for (std::size_t z = 0, i = 0; z < grid.nz; ++z)
        for (std::size_t y = 0; y < grid.ny; ++y)
            for (std::size_t x = 0; x < grid.nx; ++x, ++i) {
                float d = job.distance[i] / grid.h();
                if (d <= 0) {
                    const float length = glm::length(field.gradient(x, y, z));
                    d -= job.thin * std::max(0.0f, 1 - (length > 0 ? length : 0));
                }
                result[i] = reference::transmittance(d, job.shift, job.alpha);
            }
    return result;
}

}  // namespace

void sweep_occlusion_reference(const OcclusionJob& job) {
    const Grid& grid = job.grid;
    const SignedField signed_field{grid, job.distance};
    const std::vector<float> tau = transmittances(job);
    const bool even =
        std::all_of(job.intensities.begin(), job.intensities.end(), [](float i) { return i == 1; });
    // The mean of max(0, N.w) over evenly spread directions is 1/4.
    const float weight = 1 / (static_cast<float>(kOctants * job.ordinates) * (job.through ? 0.5f : 0.25f));
    std::vector<float> fields(grid.size()), mean(grid.size()), sum(grid.size(), even ? 1.0f : 0.0f);
    for (std::size_t s = 0; s < kOctants; ++s) {
        if (job.only < kOctants && job.only != s) continue;
        std::fill(mean.begin(), mean.end(), 0.0f);
        const auto ordinates = ordinates_of(s, job.ordinates);
        for (std::size_t o = 0; o < job.ordinates; ++o) {
            const Ordinate& w = ordinates[o];
            const Ordinate weights = weights_of(w, grid);
            reference::sweep_visibility(grid, kSweeps[s], {weights.x, weights.y, weights.z}, tau.data(),
                                        fields.data());
            const glm::vec3 towards = -glm::normalize(glm::vec3(static_cast<float>(kSweeps[s].x) * w.x,
                                                                static_cast<float>(kSweeps[s].y) * w.y,
                                                                static_cast<float>(kSweeps[s].z) * w.z));
            for (std::size_t z = 0, i = 0; z < grid.nz; ++z)
                for (std::size_t y = 0; y < grid.ny; ++y)
                    for (std::size_t x = 0; x < grid.nx; ++x, ++i) {
                        mean[i] += fields[i] / static_cast<float>(job.ordinates);
                        const glm::vec3 gradient = signed_field.gradient(x, y, z);
                        const float length = glm::length(gradient);
                        if (!(length > 0)) continue;
                        const float cosine = glm::dot(gradient, towards) / length;
                        const float term = weight * (job.through ? std::abs(cosine) : std::max(0.0f, cosine));
                        // Of full light everywhere it is the darkness that is summed: open is exactly 1.
                        sum[i] += even ? -term * (1 - fields[i]) : term * job.intensities[s] * fields[i];
                    }
        }
        if (job.octants)
            for (std::size_t i = 0; i < grid.size(); ++i)
                job.octants[4 * (s / 4 * grid.size() + i) + s % 4] =
                    static_cast<std::uint8_t>(std::lround(255 * mean[i]));
    }
    if (!job.visibility) return;
    for (float& value : sum) value = std::max(0.0f, value);
    if (job.off_surface)
        move_off_surface(grid, job.distance, sum.data(), job.visibility);
    else
        std::copy(sum.begin(), sum.end(), job.visibility);
}

}  // namespace dfield::runtime::volume
