// Which rays of a block can hit: a few multiplications a ray decide, and the rays that are left are packed
// together so that the lookups that follow have every lane busy. Seen once a target.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

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

// Packed numbers of rays, one array a number, and their places in the block.
template<int kNumbers>
struct Packed {
    alignas(64) std::array<RayArray<float>, kNumbers> numbers;
    alignas(64) RayArray<std::int32_t> id;
    std::size_t count = 0;

    HWY_INLINE void add(const std::array<VF, kNumbers>& values, VI ids, MF kept) {
        // Compressed in the register and stored whole: compressing stores are slow on some processors.
        const Packing pack(kept);
        for (int k = 0; k < kNumbers; ++k) hn::StoreU(pack(values[k]), F(), numbers[k].data() + count);
        hn::StoreU(pack(ids), I(), id.data() + count);
        count += hn::CountTrue(F(), kept);
    }
    HWY_INLINE V3 vector(int first, std::size_t k) const {
        return {hn::LoadU(F(), numbers[first].data() + k), hn::LoadU(F(), numbers[first + 1].data() + k),
                hn::LoadU(F(), numbers[first + 2].data() + k)};
    }
    HWY_INLINE VI ids(std::size_t k) const { return hn::LoadU(I(), id.data() + k); }
};

// The indices of the next rays.
HWY_INLINE VI next(VI ids) {
    return hn::Add(ids, hn::Set(I(), static_cast<std::int32_t>(hn::Lanes(I()))));
}

// Lanes of rays [i, count) that no earlier instance has blocked.
HWY_INLINE MF open_lanes(const std::uint8_t* blocked, std::size_t i, std::size_t count) {
    const F f;
    const hn::Rebind<std::uint8_t, F> bytes;
    const MF inside = hn::FirstN(f, count - i);
    if (!blocked) return inside;
    const auto taken = hn::PromoteTo(I(), hn::LoadU(bytes, blocked + i));
    return hn::And(inside, hn::RebindMask(f, hn::Eq(taken, hn::Zero(I()))));
}

// Which directions w lead from a point o outside the unit sphere past its centre within a radius or little
// more, where a matrix M carries them to the sphere's space: (o.Mw)^2 > (o.o - 1) |Mw|^2, a polynomial of w.
struct Silhouette {
    VF xx, yy, zz, xy, xz, yz;

    HWY_INLINE Silhouette(const glm::vec3& o, const glm::mat3& m) {
        const glm::vec3 towards = o * m;
        const float outside = 0.999f * (glm::dot(o, o) - 1);
        const auto term = [&](int i, int j) {
            return towards[i] * towards[j] - outside * glm::dot(m[i], m[j]);
        };
        xx = set(term(0, 0)), yy = set(term(1, 1)), zz = set(term(2, 2));
        xy = set(2 * term(0, 1)), xz = set(2 * term(0, 2)), yz = set(2 * term(1, 2));
    }
    HWY_INLINE MF holds(const V3& w) const {
        const VF a = hn::MulAdd(xx, w.x, hn::MulAdd(xy, w.y, hn::Mul(xz, w.z)));
        const VF b = hn::MulAdd(yy, w.y, hn::Mul(yz, w.z));
        return hn::Gt(hn::MulAdd(a, w.x, hn::MulAdd(b, w.y, hn::Mul(hn::Mul(zz, w.z), w.z))), set(0));
    }
};

// Rays of one origin that are left, directions in the caller's frame.
class SharedRays {
  public:
    // `radius`: of the sphere in the space where the rays are then given; the query is in the unit sphere's.
    // Keeps the rays that meet the unit sphere ahead of the origin and may meet the object's box, and some
    // that just miss the sphere: the chord knows.
    HWY_INLINE SharedRays(const RayQuery& query, const float* x, const float* y, const float* z,
                          std::size_t count, const std::uint8_t* blocked, float radius = 1)
        : origin_(set(radius * query.origin)), carry_(radius * query.carry) {
        const F f;
        const float outside = glm::dot(query.origin, query.origin) - 1;
        const V3 towards = set(query.origin * query.carry);
        const Silhouette silhouette(query.origin, query.carry);
        std::array<glm::vec3, 3> outward;
        std::size_t faces = 0;
        for (const glm::vec3& face : query.leaving.outward)
            if (face != glm::vec3(0)) outward[faces++] = face;
        VI ids = hn::Iota(I(), 0);
        for (std::size_t i = 0; i < count; i += hn::Lanes(f), ids = next(ids)) {
            const V3 w{hn::LoadU(f, x + i), hn::LoadU(f, y + i), hn::LoadU(f, z + i)};
            MF kept = open_lanes(blocked, i, count);
            if (outside > 0) {
                kept = hn::And(kept, hn::And(hn::Lt(dot(towards, w), set(0)), silhouette.holds(w)));
            }
            if (hn::AllFalse(f, kept)) continue;
            for (std::size_t face = 0; face < faces; ++face)
                kept = hn::And(kept, hn::Le(dot(set(outward[face]), w), set(0)));
            packed_.add({w.x, w.y, w.z}, ids, kept);
        }
    }

    // For `add`.
    explicit HWY_INLINE SharedRays(const SharedRays& other, int)
        : origin_(other.origin_), carry_(other.carry_) {}
    HWY_INLINE void add(const SharedRays& other, std::size_t k, MF kept) {
        const V3 w = other.packed_.vector(0, k);
        packed_.add({w.x, w.y, w.z}, other.packed_.ids(k), kept);
    }

    std::size_t count() const { return packed_.count; }
    HWY_INLINE V3 origin(std::size_t) const { return origin_; }
    HWY_INLINE V3 direction(std::size_t k) const {
        const V3 w = packed_.vector(0, k);
        return carry_(w.x, w.y, w.z);
    }
    HWY_INLINE VI ids(std::size_t k) const { return packed_.ids(k); }

  private:
    Packed<3> packed_;
    V3 origin_;
    M3 carry_;
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
class OwnRays {
  public:
    HWY_INLINE OwnRays(const SphereSpace& space, const Instance& instance, bool always_leave,
                       const RayBlock& rays, const std::uint8_t* blocked) {
        const F f;
        const M3 to_sphere(space.to_sphere), to_box(instance.to_unit);
        const V3 offset = set(space.offset), box_offset = set(instance.unit_offset - instance.box_centre);
        const glm::vec3 half = (1 - 1e-4f) * instance.box_half;           // LeavingBox's contact
        const VF zero = hn::Zero(f), one = set(1), almost = set(0.999f);  // the chord knows
        VI ids = hn::Iota(I(), 0);
        for (std::size_t i = 0; i < rays.count; i += hn::Lanes(f), ids = next(ids)) {
            const VF x = hn::LoadU(f, rays.x + i), y = hn::LoadU(f, rays.y + i), z = hn::LoadU(f, rays.z + i);
            const VF ox = hn::LoadU(f, rays.origin_x + i), oy = hn::LoadU(f, rays.origin_y + i),
                     oz = hn::LoadU(f, rays.origin_z + i);
            const V3 d = to_sphere(x, y, z), o = along(to_sphere(ox, oy, oz), one, offset);
            const VF outside = hn::Sub(dot(o, o), set(space.radius * space.radius)), approach = dot(o, d);
            const MF ahead =
                hn::And(hn::Lt(approach, zero),
                        hn::Gt(hn::Mul(approach, approach), hn::Mul(hn::Mul(dot(d, d), outside), almost)));
            const MF inside = hn::Le(outside, zero);
            MF kept = hn::And(open_lanes(blocked, i, rays.count), hn::Or(ahead, inside));
            if (hn::AllFalse(f, kept)) continue;
            const V3 p = along(to_box(ox, oy, oz), one, box_offset), w = to_box(x, y, z);
            const auto leaves = [zero](VF place, VF direction, float size) HWY_ATTR {
                return hn::And(hn::Ge(hn::Abs(place), set(size)), hn::Gt(hn::Mul(place, direction), zero));
            };
            const MF leaving =
                hn::Or(leaves(p.x, w.x, half.x), hn::Or(leaves(p.y, w.y, half.y), leaves(p.z, w.z, half.z)));
            kept = hn::And(kept, hn::Not(always_leave ? leaving : hn::And(inside, leaving)));
            packed_.add({o.x, o.y, o.z, d.x, d.y, d.z}, ids, kept);
        }
    }

    explicit HWY_INLINE OwnRays(const OwnRays&, int) {}
    HWY_INLINE void add(const OwnRays& other, std::size_t k, MF kept) {
        const V3 o = other.origin(k), d = other.direction(k);
        packed_.add({o.x, o.y, o.z, d.x, d.y, d.z}, other.ids(k), kept);
    }

    std::size_t count() const { return packed_.count; }
    HWY_INLINE V3 origin(std::size_t k) const { return packed_.vector(0, k); }
    HWY_INLINE V3 direction(std::size_t k) const { return packed_.vector(3, k); }
    HWY_INLINE VI ids(std::size_t k) const { return packed_.ids(k); }

  private:
    Packed<6> packed_;
};

// The rays that hit, gathered before any is marked.
class Marks {
  public:
    // Lanes [k, ...) of the packed rays. Those without a hit mark the padding: cheaper than a loop whose
    // length nobody can predict.
    HWY_INLINE void put(std::size_t k, VI ids, MF hits) {
        hn::StoreU(hn::IfThenElse(hn::RebindMask(I(), hits), ids, hn::Set(I(), kRayBlock)), I(),
                   ids_.data() + k);
    }
    HWY_INLINE void write(std::size_t count, std::uint8_t* blocked) const {
        for (std::size_t k = 0; k < count; ++k) blocked[ids_[k]] = 1;
    }

  private:
    alignas(64) RayArray<std::int32_t> ids_;
};

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
