// Which rays of a block can hit: a few multiplications a ray decide, and the rays that are left are packed
// together so that the lookups that follow have every lane busy. Seen once a target.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>

#include "rays/ray_query.hpp"
#include "rays/vector-inl.hpp"

#if defined(DFIELD_RAYS_CULL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_CULL_INL
#undef DFIELD_RAYS_CULL_INL
#else
#define DFIELD_RAYS_CULL_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

template<class T>
using RayArray = std::array<T, kRayBlock + kRayPadding>;

// Packed numbers of rays, one array a number, and if asked for their places in the block.
template<int kNumbers, bool kPlaces>
struct Packed {
    alignas(64) std::array<RayArray<float>, kNumbers> numbers;
    alignas(64) std::array<RayArray<std::int32_t>, kPlaces> places;

    // Adds the lanes that are kept; `count` rays have been added before. Returns how many then have.
    HWY_INLINE std::size_t add(const std::array<VF, kNumbers>& values, VI ids, MF kept, std::size_t count) {
        // Compressed in the register and stored whole: compressing stores are slow on some processors.
        const Packing pack(kept);
        for (int k = 0; k < kNumbers; ++k) hn::StoreU(pack(values[k]), F(), numbers[k].data() + count);
        if constexpr (kPlaces) hn::StoreU(pack(ids), I(), places[0].data() + count);
        return count + hn::CountTrue(F(), kept);
    }
    HWY_INLINE V3 vector(int first, std::size_t k) const {
        return {hn::LoadU(F(), numbers[first].data() + k), hn::LoadU(F(), numbers[first + 1].data() + k),
                hn::LoadU(F(), numbers[first + 2].data() + k)};
    }
    HWY_INLINE VI ids(std::size_t k) const { return hn::LoadU(I(), places[0].data() + k); }
};

// A vector of each ray of a block, handed from one step to the next.
struct RayVectors {
    alignas(64) std::array<RayArray<float>, 3> axes;

    HWY_INLINE void put(std::size_t k, const V3& v) {
        hn::Store(v.x, F(), axes[0].data() + k);
        hn::Store(v.y, F(), axes[1].data() + k);
        hn::Store(v.z, F(), axes[2].data() + k);
    }
    HWY_INLINE V3 operator[](std::size_t k) const {
        return {hn::Load(F(), axes[0].data() + k), hn::Load(F(), axes[1].data() + k),
                hn::Load(F(), axes[2].data() + k)};
    }
};

// The indices of rays from i on.
HWY_INLINE VI ids_from(std::size_t i) {
    return hn::Add(hn::Iota(I(), 0), hn::Set(I(), static_cast<std::int32_t>(i)));
}

// Bits of the vector at i, a multiple of its length.
HWY_INLINE MF lanes_at(const RayBits& bits, std::size_t i) {
    return mask_of_bits(static_cast<std::uint32_t>(bits[i / 64] >> i % 64));
}
HWY_INLINE void add_lanes(RayBits& bits, std::size_t i, MF lanes) {
    bits[i / 64] |= std::uint64_t{bits_of_mask(lanes)} << i % 64;
}
HWY_INLINE void remove_lanes(RayBits& bits, std::size_t i, MF lanes) {
    bits[i / 64] &= ~(std::uint64_t{bits_of_mask(lanes)} << i % 64);
}

// Which directions w lead from a point o outside the unit sphere past its centre within a radius or little
// more, where a matrix M carries them to the sphere's space: (o.Mw)^2 > (o.o - 1) |Mw|^2, a polynomial w.Qw.
struct Silhouette {
    glm::vec3 towards;   // o.Mw = towards.w
    float square;        // of the length of `towards`
    glm::vec3 diagonal;  // of Q
    float xy, xz, yz;    // the rest of Q
    float least;         // of what is subtracted from (towards.w)^2, for any unit w
    bool round;          // M only turns and scales: that is all that is ever subtracted

    HWY_INLINE Silhouette(const glm::vec3& o, const glm::mat3& m)
        : towards(o * m), square(glm::dot(towards, towards)) {
        const float outside = 0.999f * (glm::dot(o, o) - 1);
        const glm::vec3 gram(glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2]));
        const glm::vec3 skew(glm::dot(m[1], m[2]), glm::dot(m[0], m[2]), glm::dot(m[0], m[1]));
        diagonal = towards * towards - outside * gram;
        xy = towards.x * towards.y - outside * skew.z;
        xz = towards.x * towards.z - outside * skew.y;
        yz = towards.y * towards.z - outside * skew.x;
        // Gershgorin's bounds on what |Mw|^2 can be.
        const glm::vec3 off(glm::abs(skew)), away(off.y + off.z, off.x + off.z, off.x + off.y);
        const glm::vec3 low = gram - away, high = gram + away;
        const float smallest = std::max(0.0f, std::min(low.x, std::min(low.y, low.z)));
        least = outside * smallest;
        round = std::max(high.x, std::max(high.y, high.z)) < 1.0001f * smallest;
    }

    // Cones with such a direction ahead, and perhaps some that only nearly have one.
    HWY_INLINE MF may_hold(const V3& a, VF tangent) const {
        const V3 q{hn::MulAdd(set(diagonal.x), a.x, hn::MulAdd(set(xy), a.y, hn::Mul(set(xz), a.z))),
                   hn::MulAdd(set(xy), a.x, hn::MulAdd(set(diagonal.y), a.y, hn::Mul(set(yz), a.z))),
                   hn::MulAdd(set(xz), a.x, hn::MulAdd(set(yz), a.y, hn::Mul(set(diagonal.z), a.z)))};
        // With w = a + tan u, u at right angles to a: w.Qw = a.Qa + 2 tan u.Qa + tan^2 u.Qu.
        const VF value = dot(a, q), ahead = dot(set(towards), a);
        const V3 aside = along(q, hn::Neg(value), a);
        const VF slope = hn::Sqrt(dot(aside, aside));
        const VF bend = hn::Max(hn::NegMulAdd(ahead, ahead, set(square - least)), set(0));
        const VF most = hn::MulAdd(tangent, hn::MulAdd(tangent, bend, hn::Add(slope, slope)), value);
        const VF behind = hn::Max(ahead, set(0));
        return hn::And(hn::Gt(most, set(0)),
                       hn::Le(hn::Mul(behind, behind), hn::Mul(set(square), hn::Mul(tangent, tangent))));
    }
};

// Single directions that a Silhouette holds.
struct Ahead {
    V3 towards;
    VF xx, yy, zz, xy, xz, yz;

    explicit HWY_INLINE Ahead(const Silhouette& s)
        : towards(set(s.towards)),
          xx(set(s.diagonal.x)),
          yy(set(s.diagonal.y)),
          zz(set(s.diagonal.z)),
          xy(set(2 * s.xy)),
          xz(set(2 * s.xz)),
          yz(set(2 * s.yz)) {}
    HWY_INLINE MF operator()(const V3& w) const {
        const VF a = hn::MulAdd(xx, w.x, hn::MulAdd(xy, w.y, hn::Mul(xz, w.z)));
        const VF b = hn::MulAdd(yy, w.y, hn::Mul(yz, w.z));
        const VF value = hn::MulAdd(a, w.x, hn::MulAdd(b, w.y, hn::Mul(hn::Mul(zz, w.z), w.z)));
        return hn::And(hn::Lt(dot(towards, w), set(0)), hn::Gt(value, set(0)));
    }
};
// The same where the silhouette is round, and directions are unit to 1e-3.
struct AheadRound {
    V3 towards;
    VF most;

    explicit HWY_INLINE AheadRound(const Silhouette& s)
        : towards(set(s.towards)), most(set(-std::sqrt(0.997f * s.least))) {}
    HWY_INLINE MF operator()(const V3& w) const { return hn::Lt(dot(towards, w), most); }
};
struct Anywhere {
    HWY_INLINE MF operator()(const V3& w) const { return hn::Eq(w.x, w.x); }
};

// Rays of one origin that are left, directions in the caller's frame.
template<bool kPlaces>
class SharedRays {
  public:
    // `radius`: of the sphere in the space where the rays are then given; the query is in the unit sphere's.
    // Of the open rays, keeps those that meet the unit sphere ahead of the origin and may meet the object's
    // box, and some that just miss the sphere: the chord knows.
    HWY_INLINE SharedRays(const RayQuery& query, const GroupedRays& rays, const RayBits& open,
                          float radius = 1)
        : origin_(set(radius * query.origin)), carry_(radius * query.carry) {
        for (const glm::vec3& face : query.leaving.outward)
            if (face != glm::vec3(0)) outward_[faces_++] = face;
        const Silhouette silhouette(query.origin, query.carry);
        if (!(glm::dot(query.origin, query.origin) > 1))
            pack(rays, open, groups(rays, [](const V3& a, VF) HWY_ATTR { return Anywhere()(a); }),
                 Anywhere());
        else {
            const std::uint32_t left = groups(
                rays, [&](const V3& a, VF tangent) HWY_ATTR { return silhouette.may_hold(a, tangent); });
            silhouette.round ? pack(rays, open, left, AheadRound(silhouette))
                             : pack(rays, open, left, Ahead(silhouette));
        }
    }

    // For `add`.
    explicit HWY_INLINE SharedRays(const SharedRays& other, int)
        : origin_(other.origin_), carry_(other.carry_) {}
    HWY_INLINE void add(const SharedRays& other, std::size_t k, MF kept) {
        const V3 w = other.packed_.vector(0, k);
        count_ = packed_.add({w.x, w.y, w.z}, other.packed_.ids(k), kept, count_);
    }

    std::size_t count() const { return count_; }
    const RayBits& kept() const { return kept_; }
    HWY_INLINE V3 origin(std::size_t) const { return origin_; }
    HWY_INLINE V3 direction(std::size_t k) const {
        const V3 w = packed_.vector(0, k);
        return carry_(w.x, w.y, w.z);
    }
    HWY_INLINE VI ids(std::size_t k) const { return packed_.ids(k); }

  private:
    // A bit for each group of rays that may hold one to keep.
    template<class MayHold>
    HWY_INLINE std::uint32_t groups(const GroupedRays& rays, const MayHold& may_hold) const {
        const F f;
        std::uint32_t result = 0;
        for (std::size_t g = 0; g < rays.groups; g += hn::Lanes(f)) {
            const V3 axis{hn::LoadU(f, rays.cones.x + g), hn::LoadU(f, rays.cones.y + g),
                          hn::LoadU(f, rays.cones.z + g)};
            const VF tangent = hn::LoadU(f, rays.cones.tangent + g);
            MF kept = hn::And(hn::FirstN(f, rays.groups - g), may_hold(axis, tangent));
            for (std::size_t face = 0; face < faces_; ++face)
                kept = hn::And(kept, hn::Le(dot(set(outward_[face]), axis),
                                            hn::Mul(set(glm::length(outward_[face])), tangent)));
            result |= bits_of_mask(kept) << g;
        }
        return result;
    }

    template<class Keep>
    HWY_INLINE void pack(const GroupedRays& rays, const RayBits& open, std::uint32_t groups,
                         const Keep& keep) {
        const F f;
        std::size_t count = 0;
        for (; groups != 0; groups &= groups - 1) {
            const std::size_t first = kRayGroup * static_cast<std::size_t>(std::countr_zero(groups));
            for (std::size_t i = first; i < first + kRayGroup; i += hn::Lanes(f)) {
                const V3 w{hn::LoadU(f, rays.x + i), hn::LoadU(f, rays.y + i), hn::LoadU(f, rays.z + i)};
                MF kept = hn::And(lanes_at(open, i), keep(w));
                for (std::size_t face = 0; face < faces_; ++face)
                    kept = hn::And(kept, hn::Le(dot(set(outward_[face]), w), set(0)));
                add_lanes(kept_, i, kept);
                count = packed_.add({w.x, w.y, w.z}, ids_from(i), kept, count);
            }
        }
        count_ = count;
    }

    Packed<3, kPlaces> packed_;
    std::size_t count_ = 0;
    RayBits kept_{};
    V3 origin_;
    M3 carry_;
    std::array<glm::vec3, 3> outward_;
    std::size_t faces_ = 0;
};

// Where a kind of lookup takes place: the map from the world to the space of its sphere, which has this
// radius there.
struct SphereSpace {
    glm::mat3 to_sphere;
    glm::vec3 offset;
    float radius = 1;
};

// Rays with an origin each, carried into the sphere's space. `always_leave`: rays that start beside the box
// and lead away are dropped wherever they start, not only inside the sphere.
template<bool kPlaces>
class OwnRays {
  public:
    HWY_INLINE OwnRays(const SphereSpace& space, const Instance& instance, bool always_leave,
                       const RayBlock& rays, const RayBits& open) {
        const F f;
        const M3 to_sphere(space.to_sphere), to_box(instance.to_unit);
        const V3 offset = set(space.offset), box_offset = set(instance.unit_offset - instance.box_centre);
        const glm::vec3 half = (1 - 1e-4f) * instance.box_half;           // LeavingBox's contact
        const VF zero = hn::Zero(f), one = set(1), almost = set(0.999f);  // the chord knows
        for (std::size_t i = 0; i < rays.count; i += hn::Lanes(f)) {
            const VF x = hn::LoadU(f, rays.x + i), y = hn::LoadU(f, rays.y + i), z = hn::LoadU(f, rays.z + i);
            const VF ox = hn::LoadU(f, rays.origin_x + i), oy = hn::LoadU(f, rays.origin_y + i),
                     oz = hn::LoadU(f, rays.origin_z + i);
            const V3 d = to_sphere(x, y, z), o = along(to_sphere(ox, oy, oz), one, offset);
            const VF outside = hn::Sub(dot(o, o), set(space.radius * space.radius)), approach = dot(o, d);
            const MF ahead =
                hn::And(hn::Lt(approach, zero),
                        hn::Gt(hn::Mul(approach, approach), hn::Mul(hn::Mul(dot(d, d), outside), almost)));
            const MF inside = hn::Le(outside, zero);
            MF kept = hn::And(lanes_at(open, i), hn::Or(ahead, inside));
            if (hn::AllFalse(f, kept)) continue;
            const V3 p = along(to_box(ox, oy, oz), one, box_offset), w = to_box(x, y, z);
            const auto leaves = [zero](VF place, VF direction, float size) HWY_ATTR {
                return hn::And(hn::Ge(hn::Abs(place), set(size)), hn::Gt(hn::Mul(place, direction), zero));
            };
            const MF leaving =
                hn::Or(leaves(p.x, w.x, half.x), hn::Or(leaves(p.y, w.y, half.y), leaves(p.z, w.z, half.z)));
            kept = hn::And(kept, hn::Not(always_leave ? leaving : hn::And(inside, leaving)));
            add_lanes(kept_, i, kept);
            count_ = packed_.add({o.x, o.y, o.z, d.x, d.y, d.z}, ids_from(i), kept, count_);
        }
    }

    explicit HWY_INLINE OwnRays(const OwnRays&, int) {}
    HWY_INLINE void add(const OwnRays& other, std::size_t k, MF kept) {
        const V3 o = other.origin(k), d = other.direction(k);
        count_ = packed_.add({o.x, o.y, o.z, d.x, d.y, d.z}, other.ids(k), kept, count_);
    }

    std::size_t count() const { return count_; }
    const RayBits& kept() const { return kept_; }
    HWY_INLINE V3 origin(std::size_t k) const { return packed_.vector(0, k); }
    HWY_INLINE V3 direction(std::size_t k) const { return packed_.vector(3, k); }
    HWY_INLINE VI ids(std::size_t k) const { return packed_.ids(k); }

  private:
    Packed<6, kPlaces> packed_;
    std::size_t count_ = 0;
    RayBits kept_{};
};

// Closes the rays of `kept` whose bits, packed in `hits`, are set.
HWY_INLINE void close_rays(const RayBits& kept, const RayBits& hits, RayBits& open) {
    std::size_t place = 0;
    for (std::size_t word = 0; word < kept.size(); ++word) {
        std::uint64_t bits = hits[place / 64] >> place % 64;
        if (place % 64 != 0) bits |= hits[place / 64 + 1] << (64 - place % 64);
        open[word] &= ~deposit(bits, kept[word]);
        place += static_cast<std::size_t>(std::popcount(kept[word]));
    }
}

// nearest[id] becomes the smaller of itself and t.
HWY_INLINE void lower(VI ids, MF hits, VF t, float* nearest) {
    alignas(64) std::int32_t list[hn::MaxLanes(I())];
    alignas(64) float values[hn::MaxLanes(F())];
    const Packing pack(hits);
    hn::Store(pack(ids), I(), list);
    hn::Store(pack(t), F(), values);
    const std::size_t count = hn::CountTrue(F(), hits);
    for (std::size_t k = 0; k < count; ++k) nearest[list[k]] = std::min(nearest[list[k]], values[k]);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
