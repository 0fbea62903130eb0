// Carrying a cluster of lines into an instance: which stored direction stands for each, and the affine map
// from a receiver's position to its texel. The vector form of DirectionLookup's constructor.
#if defined(DFIELD_PREPARE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_PREPARE_INL
#undef DFIELD_PREPARE_INL
#else
#define DFIELD_PREPARE_INL
#endif

#include <hwy/highway.h>

#include <array>

#include "batch/map_lookup-inl.hpp"
#include "batch/prepared.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// More texels than rounding of a receiver's coordinates, its block's box and both's sums amounts to.
constexpr float kTexelMargin = 0.02f;

struct V3 {
    V x, y, z;
};
HWY_INLINE V dot(V3 a, V3 b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 scaled(V s, V3 a) {
    return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 plus_scaled(V3 a, V s, V3 b) {  // a + s b
    return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}

// sin(pi/2 x) for x in [0, 1]; within 2e-7.
HWY_INLINE V sine_of_turn(F d, V x) {
    const V y = hn::Mul(x, x);
    V p = hn::Set(d, 0.00015129f);
    p = hn::MulAdd(p, y, hn::Set(d, -0.00467376f));
    p = hn::MulAdd(p, y, hn::Set(d, 0.07968968f));
    p = hn::MulAdd(p, y, hn::Set(d, -0.64596371f));
    p = hn::MulAdd(p, y, hn::Set(d, 1.57079633f));
    return hn::Mul(x, p);
}

// The angle of (x, y) in quarter turns, as quarter_turns of format/angle.hpp.
HWY_INLINE V quarter_turns_of(F d, V x, V y) {
    const V ax = hn::Abs(x), ay = hn::Abs(y);
    const V slope = hn::Div(hn::Min(ax, ay), hn::Max(hn::Max(ax, ay), hn::Set(d, 1e-30f)));
    const V s = hn::Mul(slope, slope);
    V p = hn::Set(d, -0.00746194768f);
    p = hn::MulAdd(p, s, hn::Set(d, 0.0335201446f));
    p = hn::MulAdd(p, s, hn::Set(d, -0.0741234672f));
    p = hn::MulAdd(p, s, hn::Set(d, 0.123213593f));
    p = hn::MulAdd(p, s, hn::Set(d, -0.211754678f));
    p = hn::MulAdd(p, s, hn::Set(d, 0.636605296f));
    V turns = hn::Mul(slope, p);
    turns = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 1.0f), turns), turns);
    turns = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, 2.0f), turns), turns);
    return hn::IfThenElse(hn::Lt(y, hn::Zero(d)), hn::Sub(hn::Set(d, 4.0f), turns), turns);
}

// Bytes of a packed frame, as floats.
template<int kByte>
HWY_INLINE V frame_byte(F d, hn::Vec<I> word) {
    const I i;
    return hn::ConvertTo(d, hn::And(hn::ShiftRight<8 * kByte>(word), hn::Set(i, 255)));
}

HWY_INLINE hn::Vec<I> gathered_word(const std::uint8_t* frames, int word, hn::Vec<I> index) {
    const I i;
#if DFIELD_AVX512 || HWY_TARGET == HWY_AVX2
    return hn::GatherOffset(i, reinterpret_cast<const std::int32_t*>(frames + 4 * word),
                            hn::ShiftLeft<3>(index));
#else
    HWY_ALIGN std::int32_t lanes[16];
    hn::Store(index, i, lanes);
    for (std::size_t lane = 0; lane < hn::Lanes(i); ++lane)
        std::memcpy(&lanes[lane], frames + 8 * lanes[lane] + 4 * word, 4);
    return hn::Load(i, lanes);
#endif
}

HWY_INLINE V gathered_float(F d, const float* values, hn::Vec<I> index) {
#if DFIELD_AVX512 || HWY_TARGET == HWY_AVX2
    return hn::GatherIndex(d, values, index);
#else
    const I i;
    HWY_ALIGN std::int32_t at[16];
    HWY_ALIGN float lanes[16];
    hn::Store(index, i, at);
    for (std::size_t lane = 0; lane < hn::Lanes(i); ++lane) lanes[lane] = values[at[lane]];
    return hn::Load(d, lanes);
#endif
}

// Fills columns first to first + kClusterSize.
inline void prepare_lines(const DirectionCaster& caster, const Slab& slab, std::size_t first,
                          PreparedLines& out) {
    const F d;
    const I in;
    const Instance& instance = caster.instance;
    const DirectionMaps& maps = caster.maps;
    const auto n = static_cast<float>(maps.parameters.subdivision);
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const V one = set(1), zero = hn::Zero(d),
            half_map = set(0.5f * static_cast<float>(maps.parameters.map_size));
    const std::uint8_t* const frames = maps.frames.front().data();
    for (std::size_t k = first; k < first + kClusterSize; k += hn::Lanes(d)) {
        // The direction in unit space, on the stored half: against the direction where that is flipped.
        const std::size_t at = slab.first + k;
        const V wx = hn::LoadU(d, &slab.shared.x[at]), wy = hn::LoadU(d, &slab.shared.y[at]),
                wz = hn::LoadU(d, &slab.shared.z[at]);
        const auto carried = [&](int row) HWY_ATTR {
            return hn::MulAdd(
                set(instance.to_unit[0][row]), wx,
                hn::MulAdd(set(instance.to_unit[1][row]), wy, hn::Mul(set(instance.to_unit[2][row]), wz)));
        };
        V3 q{carried(0), carried(1), carried(2)};
        q = scaled(hn::Div(one, hn::Sqrt(dot(q, q))), q);
        const auto turn_back = [&](hn::Mask<F> mask) HWY_ATTR {
            q = {hn::IfThenElse(mask, hn::Neg(q.x), q.x), hn::IfThenElse(mask, hn::Neg(q.y), q.y),
                 hn::IfThenElse(mask, hn::Neg(q.z), q.z)};
        };
        turn_back(hn::Lt(q.z, zero));

        // nearest_direction: the ring and the place on it.
        const V height =
            hn::Mul(set(n), hn::Sqrt(hn::Div(hn::MulAdd(q.x, q.x, hn::Mul(q.y, q.y)), hn::Add(one, q.z))));
        const V ring = hn::Min(hn::ConvertTo(d, hn::ConvertTo(in, hn::Add(height, set(0.5f)))), set(n));
        V j = hn::ConvertTo(d, hn::ConvertTo(in, hn::MulAdd(quarter_turns_of(d, q.x, q.y), ring, set(0.5f))));
        j = hn::IfThenZeroElse(hn::Ge(j, hn::Mul(set(4), ring)), j);
        const auto second_half = hn::And(hn::Eq(ring, set(n)), hn::Ge(j, hn::Add(ring, ring)));
        j = hn::IfThenElse(second_half, hn::Sub(j, hn::Add(ring, ring)), j);
        turn_back(second_half);
        const V before = hn::IfThenZeroElse(hn::Eq(ring, zero),
                                            hn::MulAdd(hn::Mul(set(2), ring), hn::Sub(ring, one), one));
        const auto index = hn::ConvertTo(in, hn::Add(before, j));  // exact below 2^24

        // stored_direction and frame_of_normal; z >= 0 throughout.
        const V share = hn::Div(ring, set(n)), square = hn::Mul(share, share);
        const V radius = hn::Mul(share, hn::Sqrt(hn::Sub(set(2), square)));
        const V turns = hn::Div(j, hn::Max(ring, one));
        const auto quadrant = hn::ConvertTo(in, turns);
        const V part = hn::Sub(turns, hn::ConvertTo(d, quadrant));
        const V sine = sine_of_turn(d, part), cosine = sine_of_turn(d, hn::Sub(one, part));
        const auto odd = hn::RebindMask(d, hn::TestBit(quadrant, hn::Set(in, 1)));
        const auto late = hn::RebindMask(d, hn::TestBit(quadrant, hn::Set(in, 2)));  // third and fourth
        V cx = hn::IfThenElse(odd, hn::Neg(sine), cosine), sy = hn::IfThenElse(odd, cosine, sine);
        cx = hn::IfThenElse(late, hn::Neg(cx), cx);
        sy = hn::IfThenElse(late, hn::Neg(sy), sy);
        const V3 s{hn::Mul(radius, cx), hn::Mul(radius, sy), hn::Sub(one, square)};
        const V a = hn::Div(set(-1), hn::Add(one, s.z)), b = hn::Mul(hn::Mul(s.x, s.y), a);
        const V3 tangent{hn::MulAdd(hn::Mul(s.x, s.x), a, one), b, hn::Neg(s.x)};
        const V3 bitangent{b, hn::MulAdd(hn::Mul(s.y, s.y), a, one), hn::Neg(s.y)};

        // unpack_direction_frame
        const auto low = gathered_word(frames, 0, index), high = gathered_word(frames, 1, index);
        const V t = hn::Mul(frame_byte<0>(d, low), set(1.0f / 256));
        const V rotation = hn::Div(one, hn::MulAdd(t, t, one));
        const V turn_cosine = hn::Mul(hn::NegMulAdd(t, t, one), rotation),
                turn_sine = hn::Mul(hn::Add(t, t), rotation);
        const V3 axis_u = plus_scaled(scaled(turn_cosine, tangent), turn_sine, bitangent);
        const V3 axis_v = plus_scaled(scaled(turn_cosine, bitangent), hn::Neg(turn_sine), tangent);
        const auto centred = [&](V byte, float scale)
                                 HWY_ATTR { return hn::Mul(hn::Sub(byte, set(128)), set(scale)); };
        const V centre_u = centred(frame_byte<1>(d, low), 1.0f / 128),
                centre_v = centred(frame_byte<2>(d, low), 1.0f / 128);
        const V half_u = hn::Mul(hn::Add(frame_byte<3>(d, low), one), set(1.0f / 256));
        const V half_v = hn::Mul(hn::Add(frame_byte<0>(d, high), one), set(1.0f / 256));
        const V depth = centred(frame_byte<1>(d, high), 1.0f / 128);
        const V slope_u = centred(frame_byte<2>(d, high), 1.0f / 64),
                slope_v = centred(frame_byte<3>(d, high), 1.0f / 64);

        // DirectionLookup: texel coordinates of a point in unit space, then of one in world space.
        const V local_x = dot(q, axis_u), local_y = dot(q, axis_v);
        const V approach = hn::NegMulAdd(slope_u, local_x, hn::NegMulAdd(slope_v, local_y, dot(q, s)));
        const V inverse = hn::Div(one, approach);
        const V3 tilt = plus_scaled(scaled(slope_u, axis_u), slope_v, axis_v);
        const V3 gradient =
            scaled(inverse, {hn::Sub(tilt.x, s.x), hn::Sub(tilt.y, s.y), hn::Sub(tilt.z, s.z)});
        const V offset =
            hn::Mul(hn::NegMulAdd(slope_u, centre_u, hn::NegMulAdd(slope_v, centre_v, depth)), inverse);
        const auto store = [&](V3 axis, V local, V centre, V half,
                               std::array<PreparedLines::Row, 4>& row) HWY_ATTR {
            const V scale = hn::Div(half_map, half);
            const V3 g = scaled(scale, plus_scaled(axis, local, gradient));
            V constant = hn::MulAdd(scale, hn::MulSub(local, offset, centre), half_map);
            constant = hn::MulAdd(g.x, set(instance.unit_offset.x), constant);
            constant = hn::MulAdd(g.y, set(instance.unit_offset.y), constant);
            constant = hn::MulAdd(g.z, set(instance.unit_offset.z), constant);
            for (int c = 0; c < 3; ++c) {
                const glm::vec3& column = instance.to_unit[c];
                hn::Store(dot(g, {set(column.x), set(column.y), set(column.z)}), d, &row[c][k]);
            }
            hn::Store(constant, d, &row[3][k]);
        };
        store(axis_u, local_x, centre_u, half_u, out.u);
        store(axis_v, local_y, centre_v, half_v, out.v);
        hn::Store(s.x, d, &out.direction[0][k]);
        hn::Store(s.y, d, &out.direction[1][k]);
        hn::Store(s.z, d, &out.direction[2][k]);
        const U un;
        hn::Store(hn::BitCast(un, index), un, &out.index[k]);
    }
}

// Of the cluster's lines, those whose map a receiver within the box can meet.
HWY_INLINE std::uint32_t lines_on_box(const PreparedLines& prepared, std::size_t first, const GroupBox& box,
                                      float map_size) {
    const F d;
    const V half_map = hn::Set(d, 0.5f * map_size), margin = hn::Set(d, 0.5f * map_size + kTexelMargin);
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < kClusterSize; i += hn::Lanes(d)) {
        const auto inside = [&](const std::array<PreparedLines::Row, 4>& row) HWY_ATTR {
            V centre = hn::Sub(hn::Load(d, &row[3][first + i]), half_map), extent = margin;
            for (int c = 0; c < 3; ++c) {
                const V a = hn::Load(d, &row[static_cast<std::size_t>(c)][first + i]);
                centre = hn::MulAdd(a, hn::Set(d, box.middle[c]), centre);
                extent = hn::MulAdd(hn::Abs(a), hn::Set(d, box.half[c]), extent);
            }
            return hn::Le(hn::Abs(centre), extent);
        };
        result |= mask_bits(d, hn::And(inside(prepared.u), inside(prepared.v))) << i;
    }
    return result;
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
