// Ambient occlusion of receivers: Algorithm 2 of the paper, receiver by receiver, all casters for a block of
// rays. reference.cpp is the plain form; this one carries the whole hemisphere into object space by one
// matrix and hands it to the kernels in rays/.
#include "visibility.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "format/frame.hpp"
#include "kind.hpp"
#include "line_lookup.hpp"
#include "rays/kernels.hpp"
#include "receivers.hpp"

namespace dfield::runtime {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Nearest hits of a block so far.
using Nearest = std::array<float, kRayBlock>;

// Whether any of a box lies in front of a receiver's tangent plane, or almost.
bool reaches_front(const Box& box, const UnitReceiver& receiver) {
    const glm::vec3 half = 0.5f * (box.high - box.low), centre = box.low + half - receiver.position;
    const float extent = glm::dot(glm::abs(receiver.normal), half);
    const float slack = 1e-5f * (extent + glm::dot(glm::abs(receiver.position), glm::vec3(1)));
    return glm::dot(receiver.normal, centre) + extent + slack > 0;
}

// Number by number: vectors that are copied whole just after they were written make the processor wait.
glm::mat3 frame_matrix(const glm::vec3& normal) {
    const auto [t, b, n] = frame_of_normal(normal);
    return {t.x, t.y, t.z, b.x, b.y, b.z, n.x, n.y, n.z};
}

// One receiver against a scene, a block of rays at a time. Rays are counted in the order of the settings'
// groups.
class ReceiverRays {
  public:
    ReceiverRays(const SceneState& scene, const dfield_ao& ao, const RayLookups& lookups,
                 const UnitReceiver& receiver)
        : scene_(scene),
          ao_(ao),
          lookups_(lookups),
          receiver_(receiver),
          frame_(ao.sampling == DFIELD_SAMPLING_HEMISPHERE ? frame_matrix(receiver.normal) : glm::mat3(1)) {}

    // Calls use(first ray, rays that are not blocked) for each block.
    template<class Use>
    void any_hits(const Use& use) const {
        for (std::size_t begin = 0; begin < ao_.ray_count; begin += kRayBlock) {
            const GroupedRays rays = ao_.groups.block(begin);
            RayBits open = first_bits(ao_.ray_count - begin);
            if (scene_.ground) {
                const glm::vec3 normal = scene_.ground->normal * frame_;
                for (std::size_t i = 0; i < rays.count(); ++i)
                    if (glm::dot(normal, rays.direction(i)) < 0) clear_bit(open, i);
            }
            for_instances([&](const RayKernels& kernels, const RayQuery& query) {
                kernels.any_hits(query, rays, open);
            });
            use(begin, open);
        }
    }

    // Calls use(first ray, count, nearest hit of each ray). Padding counts as a ray.
    template<class Use>
    void distances(const Use& use) const {
        for (std::size_t begin = 0; begin < ao_.ray_count; begin += kRayBlock) {
            const GroupedRays rays = ao_.groups.block(begin);
            Nearest nearest;
            nearest.fill(kInfinity);
            if (scene_.ground) {
                const Plane& ground = *scene_.ground;
                const float height =
                    std::max(glm::dot(ground.normal, receiver_.position) - ground.distance, 0.0f);
                const glm::vec3 normal = ground.normal * frame_;
                for (std::size_t i = 0; i < rays.count(); ++i) {
                    const float approach = glm::dot(normal, rays.direction(i));
                    if (approach < 0) nearest[i] = height / -approach;
                }
            }
            for_instances([&](const RayKernels& kernels, const RayQuery& query) {
                kernels.distances(query, rays, nearest.data());
            });
            use(begin, rays.count(), nearest);
        }
    }

    // Weight of a ray; for shared directions still to be divided by the sum over all rays.
    float weight(std::size_t i) const {
        if (ao_.sampling == DFIELD_SAMPLING_HEMISPHERE) return ao_.groups.weight[i];
        return ao_.groups.weight[i] * std::max(cosine(i), 0.0f);
    }
    bool above(std::size_t i) const { return ao_.sampling == DFIELD_SAMPLING_HEMISPHERE || cosine(i) > 0; }

  private:
    // Calls look_up(kernels, query) for the instances that may block the receiver.
    template<class LookUp>
    void for_instances(const LookUp& look_up) const {
        const auto visit = [&](dfield_instance id) {
            const Instance& instance = scene_.instances[id];
            if (id == receiver_.owner) return;
            const glm::vec3 origin = instance.carry_point(receiver_.position);
            const PlaneSide side(instance, origin, receiver_.normal);
            if (side.behind) return;
            const bool in_front = !side.cut;
            const dfield_kind kind = kind_for(ao_, *instance.field);
            // batch/ and octants/ answer for these.
            if (kind == DFIELD_KIND_DIRECTIONS || kind == DFIELD_KIND_VOLUME) return;
            if (kind == DFIELD_KIND_LINES)
                return look_up(lookups_.lines,
                               line_query(instance, receiver_.position, frame_, ao_.bias, in_front));
            const glm::mat3 carry = instance.to_unit * frame_;
            look_up(lookups_.maps,
                    RayQuery{instance.field, origin, carry,
                             LeavingDirections(instance.leaving_box(origin), carry), ao_.bias, in_front});
        };
        if (scene_.hierarchy)
            scene_.hierarchy->traverse([&](const Box& box) { return reaches_front(box, receiver_); }, visit);
        else
            std::for_each(scene_.active.begin(), scene_.active.end(), visit);
    }

    float cosine(std::size_t i) const {
        return glm::dot(receiver_.normal, glm::vec3(ao_.groups.x[i], ao_.groups.y[i], ao_.groups.z[i]));
    }

    const SceneState& scene_;
    const dfield_ao& ao_;
    const RayLookups& lookups_;
    const UnitReceiver& receiver_;
    glm::mat3 frame_;  // carries the settings' directions into the world
};

// Calls use(i) for each of the first `count` rays that is not open.
template<class Use>
void for_blocked(const RayBits& open, std::size_t count, const Use& use) {
    const RayBits all = first_bits(count);
    for (std::size_t word = 0; word < open.size(); ++word)
        for (std::uint64_t blocked = all[word] & ~open[word]; blocked != 0; blocked &= blocked - 1)
            use(64 * word + static_cast<std::size_t>(std::countr_zero(blocked)));
}

float visibility_of(const ReceiverRays& rays, const dfield_ao& ao) {
    if (ao.any_hit() && ao.even()) {
        std::size_t hits = ao.ray_count;
        rays.any_hits([&](std::size_t, const RayBits& open) { hits -= count_bits(open); });
        return std::clamp(1 - static_cast<float>(hits) * ao.weight(0), 0.0f, 1.0f);
    }
    float occlusion = 0;
    if (ao.any_hit())
        rays.any_hits([&](std::size_t begin, const RayBits& open) {
            for_blocked(open, ao.ray_count - begin,
                        [&](std::size_t i) { occlusion += rays.weight(begin + i); });
        });
    else
        rays.distances([&](std::size_t begin, std::size_t count, const Nearest& nearest) {
            for (std::size_t i = 0; i < count; ++i)
                if (nearest[i] < kInfinity) occlusion += rays.weight(begin + i) * ao.occlusion(nearest[i]);
        });
    if (ao.sampling == DFIELD_SAMPLING_SHARED) {
        float whole = 0;
        for (std::size_t i = 0; i < ao.groups.padded(); ++i) whole += rays.weight(i);
        occlusion = whole > 0 ? occlusion / whole : 0;
    }
    return std::clamp(1 - occlusion, 0.0f, 1.0f);
}

// Ors into `mask`.
void mask_of(const ReceiverRays& rays, const dfield_ao& ao, std::uint32_t* mask) {
    const auto set = [&](std::size_t i) {
        const std::uint32_t r = ao.groups.ray[i];
        if (r != RayGroups::kNoRay && rays.above(i)) mask[r >> 5] |= std::uint32_t{1} << (r & 31);
    };
    if (ao.any_hit())
        rays.any_hits([&](std::size_t begin, const RayBits& open) {
            for_blocked(open, ao.ray_count - begin, [&](std::size_t i) { set(begin + i); });
        });
    else
        rays.distances([&](std::size_t begin, std::size_t count, const Nearest& nearest) {
            for (std::size_t i = 0; i < count; ++i)
                if (nearest[i] < kInfinity && nearest[i] <= ao.max_distance) set(begin + i);
        });
}

}  // namespace

void ray_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                    std::size_t begin, std::size_t end, const Strided<float>& visibility) {
    const RayLookups& lookups = ray_lookups(scene.context()->simd_targets);
    const ReceiverReader reader(receivers);
    for (std::size_t i = begin; i < end; ++i) {
        const UnitReceiver receiver = reader[i];
        *visibility.at(i) =
            receiver.usable() ? visibility_of(ReceiverRays(scene, ao, lookups, receiver), ao) : 1.0f;
    }
}

void ray_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
               std::size_t begin, std::size_t end, const Strided<std::uint32_t>& masks) {
    for (std::size_t i = begin; i < end; ++i) std::fill_n(masks.at(i), ao.mask_words(), 0u);
    add_ray_masks(scene, ao, receivers, begin, end, masks);
}

void add_ray_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                   std::size_t begin, std::size_t end, const Strided<std::uint32_t>& masks) {
    const RayLookups& lookups = ray_lookups(scene.context()->simd_targets);
    const ReceiverReader reader(receivers);
    for (std::size_t i = begin; i < end; ++i) {
        const UnitReceiver receiver = reader[i];
        if (receiver.usable()) mask_of(ReceiverRays(scene, ao, lookups, receiver), ao, masks.at(i));
    }
}

}  // namespace dfield::runtime
