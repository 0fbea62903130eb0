// Ambient occlusion of receivers: Algorithm 2 of the paper, receiver by receiver, all casters for a block of
// rays. The plain form is reference.cpp; this one carries the whole hemisphere into object space by one
// matrix, culls rays by the bounding sphere in a loop that compilers vectorise, and looks only the survivors
// up.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "any_hit_batch.hpp"
#include "ao.hpp"
#include "format/frame.hpp"
#include "lookup.hpp"
#include "scene.hpp"
#include "status.hpp"
#include "strided.hpp"

namespace dfield::runtime {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kBlock = AnyHitBatch::kCapacity;  // rays that share one stack-held set of results

// Tangent planes that cut less than this deep into an object's box (in radii) count as touching it: rounding
// of positions and transforms must not turn contact into penetration.
constexpr float kContactTolerance = 1e-4f;

struct Receiver {
    glm::vec3 position;
    Frame frame;
};

// Nearest hit so far of each ray of a block; in the any-hit case only whether it is finite counts.
using Nearest = std::array<float, kBlock>;

// How an instance lies to a receiver's tangent plane.
enum class Side { kBehind, kCutting, kInFront };

Side side_of_plane(const Instance& instance, const glm::vec3& origin, const glm::vec3& world_normal) {
    // Planes are carried by the transpose of the points' matrix.
    const glm::vec3 n = glm::transpose(instance.to_world) * world_normal;
    const float length = std::sqrt(glm::dot(n, n));
    const float height = glm::dot(n, instance.box_centre - origin);
    const float extent = glm::dot(glm::abs(n), instance.box_half);
    if (height + extent <= 0 || length - glm::dot(n, origin) <= 0) return Side::kBehind;
    return height - extent >= -kContactTolerance * length ? Side::kInFront : Side::kCutting;
}

// Indices of the rays of a block that meet the unit sphere ahead of the origin and may meet the object's box.
// `carry` takes the local direction of a ray to the sphere's space.
std::size_t cull(const dfield_ao& ao, std::size_t begin, std::size_t count, const glm::mat3& carry,
                 const glm::vec3& origin, const LeavingBox& box, std::uint16_t* survivors) {
    const float* const x = ao.x.data() + begin;
    const float* const y = ao.y.data() + begin;
    const float* const z = ao.z.data() + begin;
    const float outside = glm::dot(origin, origin) - 1;
    std::array<std::uint8_t, kBlock> meets;
    for (std::size_t i = 0; i < count; ++i) {
        const float dx = carry[0].x * x[i] + carry[1].x * y[i] + carry[2].x * z[i];
        const float dy = carry[0].y * x[i] + carry[1].y * y[i] + carry[2].y * z[i];
        const float dz = carry[0].z * x[i] + carry[1].z * y[i] + carry[2].z * z[i];
        const float approach = origin.x * dx + origin.y * dy + origin.z * dz;
        const float square = dx * dx + dy * dy + dz * dz;
        meets[i] = static_cast<std::uint8_t>((approach * approach > square * outside) &
                                             ((approach < 0) | (outside <= 0)) & !box.leaves(dx, dy, dz));
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        survivors[kept] = static_cast<std::uint16_t>(i);
        kept += meets[i];
    }
    return kept;
}

// Nearest hit of one ray, where distances count.
template<int kBits>
float hit_distance(const dfield_field& field, const Chord& chord, Side side, float bias) {
    if (side == Side::kInFront) {
        // Every hit on the line is ahead of the receiver, so the first one is the nearest.
        const LineHit hit = look_up<kBits>(field, chord, LineEnd::kEntry);
        return hit.hit ? std::max(hit.t, 0.0f) : kInfinity;
    }
    const float t = first_hit<kBits>(field, chord);
    return t >= bias ? t : kInfinity;
}

// Whether rays hit at all.
template<int kBits>
void add_any_hits(const dfield_field& field, const dfield_ao& ao, std::size_t begin, const glm::mat3& carry,
                  const glm::vec3& origin, Side side, const std::uint16_t* survivors, std::size_t kept,
                  Nearest& nearest) {
    AnyHitBatch batch;
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = survivors[k];
        const glm::vec3 local(ao.x[begin + i], ao.y[begin + i], ao.z[begin + i]);
        Chord chord;
        if (nearest[i] == kInfinity && chord_of_line(origin, carry * local, chord))
            batch.add(chord, survivors[k], ao.bias, side == Side::kInFront);
    }
    batch.look_up<kBits>(field, [&](std::uint16_t i) { nearest[i] = 0; });
}

template<int kBits>
void add_distances(const dfield_field& field, const dfield_ao& ao, std::size_t begin, const glm::mat3& carry,
                   const glm::vec3& origin, Side side, const std::uint16_t* survivors, std::size_t kept,
                   Nearest& nearest) {
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = survivors[k];
        const glm::vec3 local(ao.x[begin + i], ao.y[begin + i], ao.z[begin + i]);
        Chord chord;
        if (!chord_of_line(origin, carry * local, chord)) continue;
        nearest[i] = std::min(nearest[i], hit_distance<kBits>(field, chord, side, ao.bias));
    }
}

void add_instance(const Instance& instance, const dfield_ao& ao, const Receiver& receiver, std::size_t begin,
                  std::size_t count, Nearest& nearest) {
    const glm::vec3 origin = instance.carry_point(receiver.position);
    const Side side = side_of_plane(instance, origin, receiver.frame.normal);
    if (side == Side::kBehind) return;
    const glm::mat3 carry =
        instance.to_unit * glm::mat3(receiver.frame.tangent, receiver.frame.bitangent, receiver.frame.normal);
    std::array<std::uint16_t, kBlock> survivors;
    const std::size_t kept =
        cull(ao, begin, count, carry, origin, instance.leaving_box(origin), survivors.data());
    const dfield_field& field = *instance.field;
    with_bits(field, [&]<int kBits>() {
        if (ao.any_hit())
            add_any_hits<kBits>(field, ao, begin, carry, origin, side, survivors.data(), kept, nearest);
        else
            add_distances<kBits>(field, ao, begin, carry, origin, side, survivors.data(), kept, nearest);
    });
}

void add_ground(const Plane& ground, const dfield_ao& ao, const Receiver& receiver, std::size_t begin,
                std::size_t count, Nearest& nearest) {
    const float height = std::max(glm::dot(ground.normal, receiver.position) - ground.distance, 0.0f);
    const glm::vec3 normal = receiver.frame.to_local(ground.normal);
    for (std::size_t i = 0; i < count; ++i) {
        const float approach =
            normal.x * ao.x[begin + i] + normal.y * ao.y[begin + i] + normal.z * ao.z[begin + i];
        if (approach < 0) nearest[i] = std::min(nearest[i], height / -approach);
    }
}

// Hands the nearest hits of each block of a receiver's rays to `consume`(first ray, count, nearest).
template<class Consume>
void for_blocks(const dfield_scene& scene, const dfield_ao& ao, const Receiver& receiver,
                dfield_instance owner, const Consume& consume) {
    for (std::size_t begin = 0; begin < ao.ray_count; begin += kBlock) {
        const std::size_t count = std::min(kBlock, ao.ray_count - begin);
        Nearest nearest;
        nearest.fill(kInfinity);
        if (scene.ground) add_ground(*scene.ground, ao, receiver, begin, count, nearest);
        for (const dfield_instance id : scene.active)
            if (id != owner) add_instance(scene.instances[id], ao, receiver, begin, count, nearest);
        consume(begin, count, nearest);
    }
}

float visibility_of(const dfield_scene& scene, const dfield_ao& ao, const Receiver& receiver,
                    dfield_instance owner) {
    float occlusion = 0;
    for_blocks(scene, ao, receiver, owner, [&](std::size_t begin, std::size_t count, const Nearest& nearest) {
        if (ao.any_hit() && ao.weights.empty())
            occlusion += static_cast<float>(std::count_if(nearest.begin(), nearest.begin() + count,
                                                          [](float t) { return t < kInfinity; })) *
                         ao.weight(0);
        else
            for (std::size_t i = 0; i < count; ++i)
                occlusion += ao.weight(begin + i) * ao.occlusion(nearest[i]);
    });
    return std::clamp(1 - occlusion, 0.0f, 1.0f);
}

void mask_of(const dfield_scene& scene, const dfield_ao& ao, const Receiver& receiver, dfield_instance owner,
             std::uint32_t* mask) {
    for_blocks(scene, ao, receiver, owner, [&](std::size_t begin, std::size_t count, const Nearest& nearest) {
        for (std::size_t i = 0; i < count; ++i) {
            const bool blocked = nearest[i] < kInfinity && nearest[i] <= ao.max_distance;
            mask[(begin + i) >> 5] |= std::uint32_t{blocked} << ((begin + i) & 31);
        }
    });
}

// Runs answer(i, receiver, owner) for every receiver, or refuse(i) where position or normal are unusable.
template<class Answer, class Refuse>
void for_receivers(const dfield_scene& scene, const dfield_receivers& receivers, const Answer& answer,
                   const Refuse& refuse) {
    const Strided<const float> positions(receivers.positions, receivers.position_stride, 3);
    const Strided<const float> normals(receivers.normals, receivers.normal_stride, 3);
    const Strided<const dfield_instance> owners(receivers.owners, receivers.owner_stride, 1);
    scene.context()->for_ranges(receivers.count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3 position = positions.vec3(i), normal = normals.vec3(i);
            const float length = std::sqrt(glm::dot(normal, normal));
            if (finite(position) && std::isfinite(length) && length > 0)
                answer(i, Receiver{position, dfield::frame_of_normal(normal / length)},
                       owners ? *owners.at(i) : DFIELD_NO_INSTANCE);
            else
                refuse(i);
        }
    });
}

void require_receivers(const dfield_scene* scene, const dfield_ao* ao, const dfield_receivers* receivers,
                       const void* output) {
    require(scene && ao && receivers && output, "scene, ao, receivers or the output is null");
    require(receivers->count == 0 || (receivers->positions && receivers->normals),
            "the receivers' positions or normals are null");
}

}  // namespace
}  // namespace dfield::runtime

extern "C" {

dfield_status dfield_scene_visibility(const dfield_scene* scene, const dfield_ao* ao,
                                      const dfield_receivers* receivers, float* visibility,
                                      size_t visibility_stride) {
    using namespace dfield::runtime;
    return guarded([&] {
        require_receivers(scene, ao, receivers, visibility);
        const Strided<const float> self(receivers->self_visibility, receivers->self_visibility_stride, 1);
        const Strided<float> output(visibility, visibility_stride, 1);
        const auto store = [&](std::size_t i, float value) {
            *output.at(i) = self ? value * *self.at(i) : value;
        };
        for_receivers(
            *scene, *receivers,
            [&](std::size_t i, const Receiver& receiver, dfield_instance owner) {
                store(i, visibility_of(*scene, *ao, receiver, owner));
            },
            [&](std::size_t i) { store(i, 1); });
    });
}

size_t dfield_ao_get_mask_words(const dfield_ao* ao) {
    return ao ? (ao->ray_count + 31) / 32 : 0;
}

dfield_status dfield_scene_visibility_mask(const dfield_scene* scene, const dfield_ao* ao,
                                           const dfield_receivers* receivers, uint32_t* masks,
                                           size_t mask_stride) {
    using namespace dfield::runtime;
    return guarded([&] {
        require_receivers(scene, ao, receivers, masks);
        const std::size_t words = dfield_ao_get_mask_words(ao);
        const Strided<std::uint32_t> output(masks, mask_stride, words);
        const auto clear = [&](std::size_t i) { std::fill_n(output.at(i), words, 0u); };
        for_receivers(
            *scene, *receivers,
            [&](std::size_t i, const Receiver& receiver, dfield_instance owner) {
                clear(i);
                mask_of(*scene, *ao, receiver, owner, output.at(i));
            },
            clear);
    });
}
}
