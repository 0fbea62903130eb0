// Ambient occlusion of receivers: Algorithm 2 of the paper, receiver by receiver, all casters for a block of
// rays. reference.cpp is the plain form; this one carries the whole hemisphere into object space by one
// matrix and hands it to the kernels in rays/.
#include "visibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
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

// Of each ray of a block: whether it is blocked, or its nearest hit so far.
using Blocked = std::array<std::uint8_t, kRayBlock + kRayPadding>;
using Nearest = std::array<float, kRayBlock>;

// Whether any of a box lies in front of a receiver's tangent plane, or almost.
bool reaches_front(const Box& box, const UnitReceiver& receiver) {
    const glm::vec3 half = 0.5f * (box.high - box.low), centre = box.low + half - receiver.position;
    const float extent = glm::dot(glm::abs(receiver.normal), half);
    const float slack = 1e-5f * (extent + glm::dot(glm::abs(receiver.position), glm::vec3(1)));
    return glm::dot(receiver.normal, centre) + extent + slack > 0;
}

// One receiver against a scene, a block of rays at a time.
class ReceiverRays {
  public:
    ReceiverRays(const SceneState& scene, const dfield_ao& ao, const RayLookups& lookups,
                 const UnitReceiver& receiver)
        : scene_(scene), ao_(ao), lookups_(lookups), receiver_(receiver), frame_(1) {
        // Carries the directions of `ao` into the world: the normal's frame, or the world itself.
        if (ao.sampling == DFIELD_SAMPLING_HEMISPHERE) {
            const Frame frame = frame_of_normal(receiver.normal);
            frame_ = glm::mat3(frame.tangent, frame.bitangent, frame.normal);
        }
    }

    // Calls use(first ray, count, of each ray whether it is blocked).
    template<class Use>
    void any_hits(const Use& use) const {
        for (std::size_t begin = 0; begin < ao_.ray_count; begin += kRayBlock) {
            const std::size_t count = std::min(kRayBlock, ao_.ray_count - begin);
            Blocked blocked{};
            if (scene_.ground) {
                const glm::vec3 normal = scene_.ground->normal * frame_;
                for (std::size_t i = 0; i < count; ++i)
                    blocked[i] = glm::dot(normal, direction(begin + i)) < 0;
            }
            for_instances([&](const RayKernels& kernels, const RayQuery& query) {
                kernels.any_hits(query, &ao_.x[begin], &ao_.y[begin], &ao_.z[begin], count, blocked.data());
            });
            use(begin, count, blocked);
        }
    }

    // Calls use(first ray, count, nearest hit of each ray).
    template<class Use>
    void distances(const Use& use) const {
        for (std::size_t begin = 0; begin < ao_.ray_count; begin += kRayBlock) {
            const std::size_t count = std::min(kRayBlock, ao_.ray_count - begin);
            Nearest nearest;
            nearest.fill(kInfinity);
            if (scene_.ground) {
                const Plane& ground = *scene_.ground;
                const float height =
                    std::max(glm::dot(ground.normal, receiver_.position) - ground.distance, 0.0f);
                const glm::vec3 normal = ground.normal * frame_;
                for (std::size_t i = 0; i < count; ++i) {
                    const float approach = glm::dot(normal, direction(begin + i));
                    if (approach < 0) nearest[i] = height / -approach;
                }
            }
            for_instances([&](const RayKernels& kernels, const RayQuery& query) {
                kernels.distances(query, &ao_.x[begin], &ao_.y[begin], &ao_.z[begin], count, nearest.data());
            });
            use(begin, count, nearest);
        }
    }

    glm::vec3 direction(std::size_t r) const { return {ao_.x[r], ao_.y[r], ao_.z[r]}; }

    // Weight of ray r; for shared directions still to be divided by the sum over all rays.
    float weight(std::size_t r) const {
        if (ao_.sampling == DFIELD_SAMPLING_HEMISPHERE) return ao_.weight(r);
        return ao_.weight(r) * std::max(glm::dot(receiver_.normal, direction(r)), 0.0f);
    }
    bool above(std::size_t r) const {
        return ao_.sampling == DFIELD_SAMPLING_HEMISPHERE || glm::dot(receiver_.normal, direction(r)) > 0;
    }

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
            if (kind == DFIELD_KIND_DIRECTIONS) return;  // batch/ answers for it
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

    const SceneState& scene_;
    const dfield_ao& ao_;
    const RayLookups& lookups_;
    const UnitReceiver& receiver_;
    glm::mat3 frame_;
};

// Eight rays at a time: each byte of the sum counts up to kRayBlock / 8 of them.
std::size_t blocked_rays(const Blocked& blocked, std::size_t count) {
    static_assert(kRayBlock / 8 < 256);
    std::uint64_t sums = 0, word;
    std::size_t hits = 0, i = 0;
    for (; i + 8 <= count; i += 8) {
        std::memcpy(&word, &blocked[i], 8);
        sums += word;
    }
    for (; i < count; ++i) hits += blocked[i];
    for (int byte = 0; byte < 8; ++byte) hits += sums >> 8 * byte & 255;
    return hits;
}

float visibility_of(const ReceiverRays& rays, const dfield_ao& ao) {
    if (ao.any_hit() && ao.even()) {
        std::size_t hits = 0;
        rays.any_hits([&](std::size_t, std::size_t count, const Blocked& blocked) {
            hits += blocked_rays(blocked, count);
        });
        return std::clamp(1 - static_cast<float>(hits) * ao.weight(0), 0.0f, 1.0f);
    }
    float occlusion = 0, whole = 0;
    const auto add = [&](std::size_t r, float ray_occlusion) {
        const float weight = rays.weight(r);
        occlusion += weight * ray_occlusion;
        whole += weight;
    };
    if (ao.any_hit())
        rays.any_hits([&](std::size_t begin, std::size_t count, const Blocked& blocked) {
            for (std::size_t i = 0; i < count; ++i) add(begin + i, blocked[i]);
        });
    else
        rays.distances([&](std::size_t begin, std::size_t count, const Nearest& nearest) {
            for (std::size_t i = 0; i < count; ++i) add(begin + i, ao.occlusion(nearest[i]));
        });
    if (ao.sampling == DFIELD_SAMPLING_SHARED) occlusion = whole > 0 ? occlusion / whole : 0;
    return std::clamp(1 - occlusion, 0.0f, 1.0f);
}

// Ors into `mask`.
void mask_of(const ReceiverRays& rays, const dfield_ao& ao, std::uint32_t* mask) {
    const auto set = [&](std::size_t r, bool blocked) {
        mask[r >> 5] |= std::uint32_t{blocked && rays.above(r)} << (r & 31);
    };
    if (ao.any_hit())
        rays.any_hits([&](std::size_t begin, std::size_t count, const Blocked& blocked) {
            for (std::size_t i = 0; i < count; ++i) set(begin + i, blocked[i] != 0);
        });
    else
        rays.distances([&](std::size_t begin, std::size_t count, const Nearest& nearest) {
            for (std::size_t i = 0; i < count; ++i)
                set(begin + i, nearest[i] < kInfinity && nearest[i] <= ao.max_distance);
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
