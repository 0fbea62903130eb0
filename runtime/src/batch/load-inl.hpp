// Loading packed receivers, finding their cells and bounding blocks of them, vector by vector.
#if defined(DFIELD_LOAD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_LOAD_INL
#undef DFIELD_LOAD_INL
#else
#define DFIELD_LOAD_INL
#endif

#include <hwy/highway.h>

#include <limits>

#include "batch/chunk.hpp"
#include "batch/loaded.hpp"
#include "batch/map_lookup-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// The same operations in the same order as unit_receiver(), so the same bits.
inline void load_packed(const float* positions, const float* normals, Loaded& loaded) {
    const F d;
    const V infinity = hn::Set(d, std::numeric_limits<float>::infinity()),
            largest = hn::Set(d, std::numeric_limits<float>::max());
    V low_x = infinity, low_y = infinity, low_z = infinity;
    V high_x = hn::Neg(infinity), high_y = high_x, high_z = high_x;
    const auto finite = [&](V v) HWY_ATTR { return hn::Le(hn::Abs(v), largest); };
    std::size_t i = 0;
    const auto step = [&](V x, V y, V z, V nx, V ny, V nz) HWY_ATTR {
        const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Mul(nz, nz)));
        const auto usable =
            hn::And(hn::And(hn::And(finite(x), finite(y)), hn::And(finite(z), finite(length))),
                    hn::Gt(length, hn::Zero(d)));
        const V inverse = hn::Div(hn::Set(d, 1.0f), length);
        hn::Store(x, d, &loaded.x[i]);
        hn::Store(y, d, &loaded.y[i]);
        hn::Store(z, d, &loaded.z[i]);
        hn::Store(hn::IfThenElseZero(usable, hn::Mul(nx, inverse)), d, &loaded.nx[i]);
        hn::Store(hn::IfThenElseZero(usable, hn::Mul(ny, inverse)), d, &loaded.ny[i]);
        hn::Store(hn::IfThenElseZero(usable, hn::Mul(nz, inverse)), d, &loaded.nz[i]);
        low_x = hn::Min(low_x, hn::IfThenElse(usable, x, infinity));
        low_y = hn::Min(low_y, hn::IfThenElse(usable, y, infinity));
        low_z = hn::Min(low_z, hn::IfThenElse(usable, z, infinity));
        high_x = hn::Max(high_x, hn::IfThenElse(usable, x, hn::Neg(infinity)));
        high_y = hn::Max(high_y, hn::IfThenElse(usable, y, hn::Neg(infinity)));
        high_z = hn::Max(high_z, hn::IfThenElse(usable, z, hn::Neg(infinity)));
    };
    V x, y, z, nx, ny, nz;
    for (; i + hn::Lanes(d) <= loaded.count; i += hn::Lanes(d)) {
        hn::LoadInterleaved3(d, positions + 3 * i, x, y, z);
        hn::LoadInterleaved3(d, normals + 3 * i, nx, ny, nz);
        step(x, y, z, nx, ny, nz);
    }
    if (i < loaded.count) {  // what is left, with lanes without a normal
        HWY_ALIGN float rest[6][16] = {};
        for (std::size_t k = i; k < loaded.count; ++k)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                rest[axis][k - i] = positions[3 * k + axis];
                rest[3 + axis][k - i] = normals[3 * k + axis];
            }
        step(hn::Load(d, rest[0]), hn::Load(d, rest[1]), hn::Load(d, rest[2]), hn::Load(d, rest[3]),
             hn::Load(d, rest[4]), hn::Load(d, rest[5]));
    }
    const auto least = [&](V v) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, v)); };
    const auto most = [&](V v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
    loaded.low = {least(low_x), least(low_y), least(low_z)};
    loaded.high = {most(high_x), most(high_y), most(high_z)};
}

inline void find_cells(Loaded& loaded) {
    const F d;
    const U un;
    const I in;
    const V zero = hn::Zero(d), last = hn::Set(d, 15.0f), scale = hn::Set(d, loaded.cell_scale());
    const auto place =
        [&](V v, float low) HWY_ATTR {  // Min and Max give their second argument for a NaN, or a bound
            const V cell = hn::Min(hn::Max(hn::Mul(hn::Sub(v, hn::Set(d, low)), scale), zero), last);
            auto bits = hn::And(hn::BitCast(un, hn::ConvertTo(in, cell)), hn::Set(un, 15u));
            bits = hn::And(hn::Or(bits, hn::ShiftLeft<2>(bits)), hn::Set(un, 0x33u));
            return hn::And(hn::Or(bits, hn::ShiftLeft<1>(bits)), hn::Set(un, 0x55u));
        };
    for (std::size_t i = 0; i < loaded.count; i += hn::Lanes(d)) {
        const auto x = place(hn::Load(d, &loaded.x[i]), loaded.low.x),
                   y = place(hn::Load(d, &loaded.y[i]), loaded.low.y),
                   z = place(hn::Load(d, &loaded.z[i]), loaded.low.z);
        const V nx = hn::Load(d, &loaded.nx[i]), ny = hn::Load(d, &loaded.ny[i]),
                nz = hn::Load(d, &loaded.nz[i]);
        const auto side = [&](V n, std::uint32_t axis) HWY_ATTR {
            const auto first = hn::Set(un, 2 * axis << 2 * kCellBits);
            return hn::Or(first, hn::IfThenElseZero(hn::RebindMask(un, hn::Lt(n, zero)),
                                                    hn::Set(un, 1u << 2 * kCellBits)));
        };
        const auto along_x = hn::Or(side(nx, 0), hn::Or(hn::ShiftLeft<1>(y), z));
        const auto along_y = hn::Or(side(ny, 1), hn::Or(hn::ShiftLeft<1>(z), x));
        const auto along_z = hn::Or(side(nz, 2), hn::Or(hn::ShiftLeft<1>(x), y));
        const V ax = hn::Abs(nx), ay = hn::Abs(ny), az = hn::Abs(nz);
        const auto cell =
            hn::IfThenElse(hn::RebindMask(un, hn::Ge(ax, hn::Max(ay, az))), along_x,
                           hn::IfThenElse(hn::RebindMask(un, hn::Ge(ay, az)), along_y, along_z));
        const auto usable = hn::RebindMask(un, hn::Gt(hn::Add(hn::Add(ax, ay), az), zero));
        hn::Store(hn::IfThenElse(usable, cell, hn::Set(un, kNoCell)), un, &loaded.cells[i]);
    }
}

inline BlockBounds bound_block(const Chunk& chunk, std::size_t block) {
    const F d;
    const std::size_t begin = block * kLanes;
    const auto least = [&](const auto& values) HWY_ATTR {
        V v = hn::Load(d, &values[begin]);
        for (std::size_t i = hn::Lanes(d); i < kLanes; i += hn::Lanes(d))
            v = hn::Min(v, hn::Load(d, &values[begin + i]));
        return hn::GetLane(hn::MinOfLanes(d, v));
    };
    const auto most = [&](const auto& values) HWY_ATTR {
        V v = hn::Load(d, &values[begin]);
        for (std::size_t i = hn::Lanes(d); i < kLanes; i += hn::Lanes(d))
            v = hn::Max(v, hn::Load(d, &values[begin + i]));
        return hn::GetLane(hn::MaxOfLanes(d, v));
    };
    const auto sum = [&](const auto& values) HWY_ATTR {
        V v = hn::Load(d, &values[begin]);
        for (std::size_t i = hn::Lanes(d); i < kLanes; i += hn::Lanes(d))
            v = hn::Add(v, hn::Load(d, &values[begin + i]));
        return hn::GetLane(hn::SumOfLanes(d, v));
    };
    BlockBounds bounds{{least(chunk.x), least(chunk.y), least(chunk.z)},
                       {most(chunk.x), most(chunk.y), most(chunk.z)},
                       chunk.normal(begin),
                       1};
    bool flat = true;
    for (std::size_t i = begin; i < begin + kLanes; i += hn::Lanes(d)) {
        const auto same = [&](const auto& values)
                              HWY_ATTR { return hn::Eq(hn::Load(d, &values[i]), hn::Set(d, values[begin])); };
        flat &= hn::AllTrue(d, hn::And(hn::And(same(chunk.nx), same(chunk.ny)), same(chunk.nz)));
    }
    if (flat) return bounds;
    bounds.axis = {sum(chunk.nx), sum(chunk.ny), sum(chunk.nz)};
    const float length = std::sqrt(glm::dot(bounds.axis, bounds.axis));
    if (length > 0) bounds.axis /= length;
    V cosine = hn::Set(d, kLargestCosine);
    for (std::size_t i = begin; i < begin + kLanes; i += hn::Lanes(d))
        cosine = hn::Min(
            cosine, hn::MulAdd(hn::Set(d, bounds.axis.x), hn::Load(d, &chunk.nx[i]),
                               hn::MulAdd(hn::Set(d, bounds.axis.y), hn::Load(d, &chunk.ny[i]),
                                          hn::Mul(hn::Set(d, bounds.axis.z), hn::Load(d, &chunk.nz[i])))));
    bounds.cosine = hn::GetLane(hn::MinOfLanes(d, cosine));
    return bounds;
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
