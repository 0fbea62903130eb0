// Algorithm 2 of the paper as it is written, ray by ray, in double: what the fast path in visibility.cpp is
// held to. Nothing here is shared with it but the parameterizations and the file's values.
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "ao.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"
#include "format/sphere_points.hpp"
#include "scene.hpp"
#include "status.hpp"
#include "strided.hpp"

namespace dfield::runtime {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// "access distance in displacement map": of texel `texel` in map `map`, divided by the diameter; kNone for a
// miss.
double stored_distance(const dfield_field& field, std::uint32_t map, std::uint32_t texel, double cosine) {
    const std::uint8_t* const texels = field.maps.texels.data() + map * field.map_stride;
    switch (field.maps.parameters.bits) {
        case 1: {
            if ((texels[texel / 8] >> (texel % 8) & 1) == 0) return kNone;
            // "Further memory optimization": the average distance along the normal, here carried along the
            // ray.
            const double depth = field.maps.mean_depth[map] / 65535.0;
            return std::min(depth / cosine, cosine);
        }
        case 8:
            return texels[texel] == kMiss8 ? kNone : texels[texel] / 254.0;
        case 16: {
            const unsigned value = texels[2 * texel] + 256u * texels[2 * texel + 1];
            return value == kMiss16 ? kNone : value / 65534.0;
        }
        default: {
            std::uint32_t bits = 0;
            for (int byte = 3; byte >= 0; --byte) bits = bits << 8 | texels[4 * texel + byte];
            const auto value = std::bit_cast<float>(bits);
            return value >= kMiss32 ? kNone : value;
        }
    }
}

// The line o + t d in the space where the bounding sphere is the unit sphere.
struct Line {
    glm::dvec3 o, d;
    double t_in, t_out;
    bool meets_sphere;

    Line(const glm::dvec3& origin, const glm::dvec3& direction) : o(origin), d(direction) {
        // |o + t d|^2 = 1
        const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1;
        const double discriminant = b * b - a * c;
        meets_sphere = discriminant > 0;
        t_in = (-b - std::sqrt(std::max(discriminant, 0.0))) / a;
        t_out = (-b + std::sqrt(std::max(discriminant, 0.0))) / a;
    }
};

// Section 3.2: t of the hit that the field knows of, looking along the line from the point at t_end; kNone
// for none.
double look_up(const dfield_field& field, const Line& line, double t_end) {
    const FieldParameters& parameters = field.maps.parameters;
    const glm::dvec3 q = line.o + t_end * line.d;
    // "discretize intersection point (u, v)"
    const std::uint32_t map =
        nearest_sphere_point(parameters.positions, parameters.subdivision, field.points.data(), glm::vec3(q));
    const glm::dvec3 p(field.points[map]);
    // "discretize ray (phi, theta)": the pivot, aiming from p at the middle of the chord.
    const glm::dvec3 middle = line.o + 0.5 * (line.t_in + line.t_out) * line.d;
    const glm::dvec3 aim = glm::normalize(middle - p);
    const glm::vec3 local = frame_of_normal(glm::vec3(-p)).to_local(glm::vec3(aim));
    const std::uint32_t texel = direction_texel(parameters.mapping, parameters.map_size, local);
    const double distance = stored_distance(field, map, texel, local.z);
    if (distance == kNone) return kNone;
    // "use distance": the hit in the unit sphere (diameter 2), carried onto the line.
    const glm::dvec3 hit = p + 2 * distance * aim;
    return glm::dot(hit - line.o, line.d) / glm::dot(line.d, line.d);
}

// Nearest hit of one instance; "if ray intersects bounding sphere of occluder object".
double instance_distance(const Instance& instance, const glm::vec3& x, const glm::vec3& n, const glm::vec3& w,
                         const dfield_ao& ao) {
    const Line line(glm::dvec3(instance.carry_point(x)), glm::dvec3(instance.carry_direction(w)));
    if (!line.meets_sphere || line.t_out <= 0) return kNone;
    // A ray that starts beside the object's box and leads away from it cannot hit.
    for (int axis = 0; axis < 3; ++axis) {
        const double p = line.o[axis] - instance.box_centre[axis];
        if (std::fabs(p) >= (1 - 1e-4) * instance.box_half[axis] && p * line.d[axis] > 0) return kNone;
    }

    // Heights of the corners of the object's box over the receiver's tangent plane, in radii.
    double lowest = kNone, highest = -kNone;
    const glm::dvec3 plane = glm::transpose(glm::dmat3(instance.to_world)) * glm::dvec3(n);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const glm::dvec3 y = glm::dvec3(instance.box_centre) + sign * glm::dvec3(instance.box_half);
        const double height = glm::dot(plane, y - line.o) / glm::length(plane);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
    }
    if (highest <= 0) return kNone;
    if (lowest >= -1e-4) {
        // Wholly in front of the tangent plane: what is on the line is ahead.
        const bool from_exit = line.t_in < 0 && ao.any_hit();
        const double t = look_up(*instance.field, line, from_exit ? line.t_out : line.t_in);
        return t == kNone ? kNone : std::max(t, 0.0);
    }
    const double bias = ao.bias;
    if (ao.any_hit()) {
        if (line.t_out <= bias) return kNone;
        if (line.t_in >= bias) return look_up(*instance.field, line, line.t_in);
        // Backwards from the exit point: the last hit on the line.
        const double last = look_up(*instance.field, line, line.t_out);
        return last != kNone && last > bias ? last : kNone;
    }
    double t = look_up(*instance.field, line, line.t_in);
    if (t == kNone) return kNone;
    if (line.t_in >= 0)
        t = std::max(t, line.t_in);
    else if (t < 0) {
        t = look_up(*instance.field, line, line.t_out);
        if (t <= 0) return kNone;
    }
    return t >= bias ? t : kNone;
}

double receiver_visibility(const SceneState& scene, const dfield_ao& ao, const glm::vec3& x,
                           const glm::vec3& n, dfield_instance owner) {
    const bool shared = ao.sampling == DFIELD_SAMPLING_SHARED;
    const Frame frame = frame_of_normal(n);
    double visibility = 0, whole = 0;
    for (std::size_t r = 0; r < ao.ray_count; ++r) {  // "for all emanating rays"
        const glm::vec3 direction(ao.x[r], ao.y[r], ao.z[r]);
        const glm::vec3 w = shared ? direction : frame.to_world(direction);
        // A = 1/pi int V(x, w) (w . n) dw: directions around the normal carry the cosine in their density.
        const double weight = ao.weight(r) * (shared ? std::max(glm::dot(n, w), 0.0f) : 1.0);
        whole += weight;
        double nearest = kNone;
        if (scene.ground && glm::dot(scene.ground->normal, w) < 0) {
            const double height = glm::dot(scene.ground->normal, x) - scene.ground->distance;
            nearest = std::max(height, 0.0) / -glm::dot(scene.ground->normal, w);
        }
        for (const dfield_instance id : scene.active)
            if (id != owner) nearest = std::min(nearest, instance_distance(scene.instances[id], x, n, w, ao));
        visibility += weight * (1 - ao.occlusion(static_cast<float>(nearest)));
    }
    if (!shared) return visibility;
    return whole > 0 ? visibility / whole : 1;
}

}  // namespace
}  // namespace dfield::runtime

extern "C" dfield_status dfield_scene_visibility_reference(const dfield_scene* scene, const dfield_ao* ao,
                                                           const dfield_receivers* receivers,
                                                           float* visibility, size_t visibility_stride) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene && ao && receivers && visibility, "scene, ao, receivers or visibility is null");
        require(receivers->count == 0 || (receivers->positions && receivers->normals),
                "the receivers' positions or normals are null");
        for (const dfield_instance id : scene->state.active)
            require(has_maps(scene->state.instances[id].field->maps.parameters),
                    "dfield_scene_visibility_reference: an instance's field has no displacement maps");
        const Strided<const float> positions(receivers->positions, receivers->position_stride, 3);
        const Strided<const float> normals(receivers->normals, receivers->normal_stride, 3);
        const Strided<const dfield_instance> owners(receivers->owners, receivers->owner_stride, 1);
        const Strided<const float> self(receivers->self_visibility, receivers->self_visibility_stride, 1);
        const Strided<float> output(visibility, visibility_stride, 1);
        for (std::size_t i = 0; i < receivers->count;
             ++i) {  // "for all points x on the occlusion receiver surface"
            const glm::vec3 x = positions.vec3(i), n = normals.vec3(i);
            const float length = glm::length(n);
            double result = 1;
            if (finite(x) && std::isfinite(length) && length > 0)
                result = receiver_visibility(scene->state, *ao, x, n / length,
                                             owners ? *owners.at(i) : DFIELD_NO_INSTANCE);
            *output.at(i) = static_cast<float>(self ? result * *self.at(i) : result);
        }
    });
}
