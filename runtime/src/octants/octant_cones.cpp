#include "octants/octant_cones.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace dfield::runtime {

OctantCones::OctantCones(const glm::mat3& object_to_world) {
    for (std::size_t k = 0; k < 3; ++k) axis[k] = glm::normalize(object_to_world[static_cast<int>(k)]);
    volume = std::fabs(glm::dot(glm::cross(axis[0], axis[1]), axis[2]));
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3 &u = axis[(k + 1) % 3], &v = axis[(k + 2) % 3], across = glm::cross(u, v);
        cosine[k] = glm::dot(u, v);
        sine[k] = glm::length(across);
        angle[k] = std::atan2(sine[k], cosine[k]);
        normal[k] = across * ((glm::dot(across, axis[k]) < 0 ? -1.0f : 1.0f) / sine[k]);
    }
}

std::array<float, kOctantCount> octant_terms(const OctantCones& cones, const glm::vec3& n) {
    constexpr float kPi = glm::pi<float>();
    // Axes turned round until N faces all of them: a_k = N.axis, nu_k = N.normal.
    std::array<bool, 3> positive;
    std::array<float, 3> a, nu, cosine, angle;
    for (std::size_t k = 0; k < 3; ++k) {
        const float facing = glm::dot(n, cones.axis[k]);
        positive[k] = facing >= 0;
        a[k] = std::fabs(facing);
        nu[k] = (positive[k] ? 1.0f : -1.0f) * glm::dot(n, cones.normal[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const bool same = positive[(k + 1) % 3] == positive[(k + 2) % 3];
        cosine[k] = same ? cones.cosine[k] : -cones.cosine[k];
        angle[k] = same ? cones.angle[k] : kPi - cones.angle[k];
    }
    // The octant that N faces with all corners: the edges' arcs times N . their inward normals, halved.
    const float all = std::max(0.0f, 0.5f * (angle[0] * nu[0] + angle[1] * nu[1] + angle[2] * nu[2]));
    std::array<float, 3> corner, beyond;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        // Of the octant that has axis k alone on N's side: the triangle between this corner and the horizon.
        const float to_i = std::atan2(a[k] * cones.sine[j], a[i] - cosine[j] * a[k]);
        const float to_j = std::atan2(a[k] * cones.sine[i], a[j] - cosine[i] * a[k]);
        const float horizon =
            std::atan2(a[k] * cones.volume,
                       a[i] * a[j] - a[k] * (a[i] * cosine[i] + a[j] * cosine[j] - a[k] * cosine[k]));
        corner[k] = std::max(0.0f, 0.5f * (horizon - nu[j] * to_i - nu[i] * to_j));
        // Of the one opposite to it: the integral of N.w over all of it, and what lies below the horizon
        // again.
        const float whole = 0.5f * ((kPi - angle[i]) * nu[i] + (kPi - angle[j]) * nu[j] - angle[k] * nu[k]);
        beyond[k] = std::max(0.0f, corner[k] + whole);
    }
    std::array<float, kOctantCount> terms;
    for (std::size_t octant = 0; octant < kOctantCount; ++octant) {
        std::size_t opposite = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if ((octant >> k & 1) != (positive[k] ? 1u : 0u)) opposite |= std::size_t{1} << k;
        switch (opposite) {
            case 0:
                terms[octant] = all;
                break;
            case 1:
            case 2:
            case 4:
                terms[octant] = beyond[opposite >> 1];
                break;
            case 3:
            case 5:
            case 6:
                terms[octant] = corner[(7 - opposite) >> 1];
                break;
            default:
                terms[octant] = 0;
        }
    }
    return terms;
}

float ball_occlusion(float sine, float cosine) {
    const float rim = std::sqrt(std::max(0.0f, 1 - sine * sine));  // cosine of half the angle
    // Where the horizon crosses the ball; 0 where it does not.
    const float cut = std::sqrt(std::max(0.0f, sine * sine - cosine * cosine));
    const float above = sine * sine * cosine * std::atan2(cut, -cosine * rim) - rim * cut;
    return std::clamp((above + std::atan2(cut, rim)) / glm::pi<float>(), 0.0f, 1.0f);
}

}  // namespace dfield::runtime
