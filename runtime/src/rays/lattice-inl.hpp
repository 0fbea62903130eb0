// The lattice of line tables (format/line_table.hpp is the plain form). Seen once a target.
#include <cstddef>
#include <cstdint>

#include "format/line_table.hpp"
#include "rays/vector-inl.hpp"

#if defined(DFIELD_RAYS_LATTICE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_LATTICE_INL
#undef DFIELD_RAYS_LATTICE_INL
#else
#define DFIELD_RAYS_LATTICE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// Lines are looked up where the table's sphere has this radius: |x| (1 + k |x|) is then (|X| + X^2) / k of
// the larger coordinate X = k x, and the factor cancels.
inline constexpr float kLineRadius = kLatticeWarp;

// lattice_square.
struct LatticePlaces {
    VF column, row;

    HWY_INLINE LatticePlaces(std::uint32_t lattice, const V3& q) {
        const auto warp = [](VF x) HWY_ATTR { return hn::MulAdd(x, x, hn::Abs(x)); };
        const VF gx = warp(q.x), gy = warp(q.y), gz = warp(q.z);
        const VF scale = reciprocal(hn::Add(gx, hn::Add(gy, gz)));
        // Folding out the lower half, 1 - v in place of u, comes to adding gz.
        const VF folded = hn::IfThenElseZero(hn::Lt(q.z, set(0)), gz);
        const VF u = hn::Mul(hn::Add(gx, folded), scale), v = hn::Mul(hn::Add(gy, folded), scale);
        // Rounding must not lead out of the square.
        const float half = 0.5f * static_cast<float>(lattice), inside = half * (1 - 0x1p-15f);
        column = hn::MulAdd(hn::CopySign(u, q.x), set(inside), set(half));
        row = hn::MulAdd(hn::CopySign(v, q.y), set(inside), set(half));
    }
};

// nearest_lattice_point.
HWY_INLINE VI nearest_lattice_points(std::uint32_t lattice, const V3& q) {
    const LatticePlaces places(lattice, q);
    return truncated(hn::MulAdd(hn::Floor(places.row), set(static_cast<float>(lattice)), places.column));
}

// lattice_neighbours, and for each point p the number p (p + 1) / 2.
struct Neighbours {
    VI points[4], triangles[4];
    VF shares[4];

    HWY_INLINE Neighbours(std::uint32_t lattice, const V3& q) {
        const VF zero = hn::Zero(F()), one = set(1), side = set(static_cast<float>(lattice)),
                 last = hn::Sub(side, one);
        const LatticePlaces places(lattice, q);
        // A cell beyond an edge of the square is mirrored along the edge.
        struct Step {
            VF place, mirrored;
            MF beyond;
        };
        const auto steps = [&](VF at, Step(&two)[2], VF& fraction) HWY_ATTR {
            const VF shifted = hn::Sub(at, set(0.5f));
            const VF low = hn::Min(hn::Max(hn::Floor(shifted), set(-1)), last);
            fraction = hn::MulAdd(hn::Sub(shifted, low), set(kShareSlope), set(kLeastShare));
            const VF high = hn::Add(low, one);
            two[0] = {hn::Max(low, zero), hn::Min(hn::Sub(last, low), last), hn::Lt(low, zero)};
            two[1] = {hn::Min(high, last), hn::Max(hn::Sub(last, high), zero), hn::Gt(high, last)};
        };
        Step columns[2], rows[2];
        VF f, g;
        steps(places.column, columns, f);
        steps(places.row, rows, g);
        for (int k = 0; k < 4; ++k) {
            const Step &i = columns[k & 1], &j = rows[k >> 1];
            const VF point = hn::MulAdd(hn::IfThenElse(i.beyond, j.mirrored, j.place), side,
                                        hn::IfThenElse(j.beyond, i.mirrored, i.place));
            points[k] = truncated(point);
            triangles[k] = hn::ShiftRight<1>(hn::Mul(points[k], hn::Add(points[k], hn::Set(I(), 1))));
            shares[k] = hn::Mul(k & 1 ? f : hn::Sub(one, f), k >> 1 ? g : hn::Sub(one, g));
        }
    }
};

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
