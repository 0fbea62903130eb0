// Normals as normal_at() and towards_viewer() have them, to the last bit.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/lattice.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "screen/lattice.hpp"
#include "screen/vector-inl.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

// Pixels side by side, as many as one vector of every picture has.
struct Piece {
    static constexpr std::int32_t kMost = Lattice::kMostSide * Lattice::kBorder;
    static constexpr std::int32_t kPlanes = 6;  // normals, radiance
    HWY_ALIGN float values[kPlanes][kMost];
    HWY_ALIGN float loaded[3 * kMost];
};

// Three floats a pixel from where the caller has them; beyond the row's end the last pixel's.
void load_piece(const StridedPixels<const float>& from, std::int32_t first, std::int32_t count,
                std::int32_t wanted, std::int32_t row, float* HWY_RESTRICT to) {
    for (std::int32_t i = 0; i < wanted; ++i)
        std::copy_n(
            from.at(static_cast<std::size_t>(first + std::min(i, count - 1)), static_cast<std::size_t>(row)),
            3, to + 3 * i);
}

HWY_INLINE V3 position(const Frame& frame, V x, V y, V depth) {
    if (!frame.camera.perspective) return {x, y, hn::Neg(depth)};
    return {hn::Mul(x, depth), hn::Mul(y, depth), hn::Neg(depth)};
}

HWY_INLINE V3 minus(const V3& a, const V3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

// course() of frame.cpp: the neighbour at `next` has its place (ahead_x, ahead_y), the opposite one
// (behind_x, behind_y).
HWY_INLINE V3 course(const Frame& frame, const float* at, std::ptrdiff_t next, V x, V y, V ahead_x, V ahead_y,
                     V behind_x, V behind_y) {
    const F f;
    const V here = hn::LoadU(f, at), after = hn::LoadU(f, at + next), before = hn::LoadU(f, at - next);
    const V ahead = hn::Abs(hn::Sub(after, here)), behind = hn::Abs(hn::Sub(before, here));
    const V3 middle = position(frame, x, y, here);
    const M known = hn::Lt(ahead, hn::Set(f, kSky)), forwards = hn::Le(ahead, behind);
    const V3 up = minus(position(frame, ahead_x, ahead_y, hn::IfThenElse(known, after, here)), middle);
    const V3 down = minus(middle, position(frame, behind_x, behind_y, before));
    return {hn::IfThenElse(forwards, up.x, down.x), hn::IfThenElse(forwards, up.y, down.y),
            hn::IfThenElse(forwards, up.z, down.z)};
}

HWY_NOINLINE V3 derived_normals(const Frame& frame, std::int32_t column, std::int32_t row) {
    const F f;
    const Camera& camera = frame.camera;
    const float* const at = frame.depth + frame.layout.index(column, row);
    const V x = places(camera, column, 1), left = places(camera, column - 1, 1),
            right = places(camera, column + 1, 1);
    const V y = hn::Set(f, camera.at_y(row)), above = hn::Set(f, camera.at_y(row - 1)),
            below = hn::Set(f, camera.at_y(row + 1));
    const V3 a = course(frame, at, frame.layout.stride, x, y, x, below, x, above);
    const V3 b = course(frame, at, 1, x, y, right, y, left, y);
    const V3 n{hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
               hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
    const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(n.x, n.x), hn::Mul(n.y, n.y)), hn::Mul(n.z, n.z)));
    const M good = hn::And(hn::Gt(length, hn::Zero(f)), hn::Lt(length, hn::Set(f, kSky)));
    return {hn::IfThenElseZero(good, hn::Div(n.x, length)), hn::IfThenElseZero(good, hn::Div(n.y, length)),
            hn::IfThenElse(good, hn::Div(n.z, length), hn::Set(f, 1.0f))};
}

HWY_INLINE V3 given_normals(const Frame& frame, const float* HWY_RESTRICT loaded, std::int32_t column,
                            std::int32_t row) {
    const F f;
    V3 n;
    hn::LoadInterleaved3(f, loaded, n.x, n.y, n.z);
    const V squared = hn::Add(hn::Add(hn::Mul(n.x, n.x), hn::Mul(n.y, n.y)), hn::Mul(n.z, n.z));
    const V inverse = hn::Div(hn::Set(f, 1.0f), hn::Sqrt(squared));
    n = {hn::Mul(n.x, inverse), hn::Mul(n.y, inverse), hn::Mul(n.z, inverse)};
    const M good = hn::And(hn::Gt(squared, hn::Zero(f)), hn::Lt(squared, hn::Set(f, kSky)));
    if (hn::AllTrue(f, good)) return n;
    const V3 other = derived_normals(frame, column, row);
    return {hn::IfThenElse(good, n.x, other.x), hn::IfThenElse(good, n.y, other.y),
            hn::IfThenElse(good, n.z, other.z)};
}

HWY_INLINE V3 turned(const Frame& frame, const V3& n, std::int32_t column, std::int32_t row) {
    const F f;
    const V one = hn::Set(f, 1.0f);
    const V x = places(frame.sight, column, 1), y = hn::Set(f, frame.sight.at_y(row));
    const V sight_2 = hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), one));
    const V inverse = hn::Div(one, hn::Sqrt(sight_2));
    const V3 viewer{hn::Mul(hn::Neg(x), inverse), hn::Mul(hn::Neg(y), inverse), inverse};
    const V facing = hn::Add(hn::Add(hn::Mul(n.x, viewer.x), hn::Mul(n.y, viewer.y)), hn::Mul(n.z, viewer.z));
    const M away = hn::Lt(facing, hn::Set(f, kGrazing));
    if (hn::AllFalse(f, away)) return n;
    const V3 across{hn::Sub(n.x, hn::Mul(facing, viewer.x)), hn::Sub(n.y, hn::Mul(facing, viewer.y)),
                    hn::Sub(n.z, hn::Mul(facing, viewer.z))};
    const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(across.x, across.x), hn::Mul(across.y, across.y)),
                                      hn::Mul(across.z, across.z)));
    const M long_enough = hn::Gt(length, hn::Set(f, 0.5f));
    const V most = hn::Set(f, std::sqrt(1 - kGrazing * kGrazing)), least = hn::Set(f, kGrazing);
    const auto bent = [&](V kept, V along, V to) HWY_ATTR {
        const V value = hn::Add(hn::Mul(hn::Div(along, length), most), hn::Mul(least, to));
        return hn::IfThenElse(away, hn::IfThenElse(long_enough, value, to), kept);
    };
    return {bent(n.x, across.x, viewer.x), bent(n.y, across.y, viewer.y), bent(n.z, across.z, viewer.z)};
}

// A row of `side` vectors to the pictures of their places, from `column` on.
HWY_INLINE void deal(const Lattice& lattice, const float* HWY_RESTRICT from, float* HWY_RESTRICT plane,
                     std::int32_t column, std::int32_t row) {
    const F f;
    const std::int32_t y = row % lattice.side, row_there = row / lattice.side;
    float* const to = plane + lattice.index(0, y, column, row_there);
    if (lattice.side == 4) {
        V a, b, c, d;
        hn::LoadInterleaved4(f, from, a, b, c, d);
        hn::StoreU(a, f, to);
        hn::StoreU(b, f, to + lattice.picture);
        hn::StoreU(c, f, to + 2 * lattice.picture);
        hn::StoreU(d, f, to + 3 * lattice.picture);
        return;
    }
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(f));
    for (std::int32_t x = 0; x < lattice.side; ++x)
        for (std::int32_t i = 0; i < lanes; ++i) to[x * lattice.picture + i] = from[i * lattice.side + x];
}

// Vectors of normals and radiance to a lattice of side 1.
HWY_INLINE void put_quads(const Lattice& lattice, const Piece& piece, std::int32_t column, std::int32_t row) {
    const F f;
    constexpr std::size_t kLanes = hn::MaxLanes(F());
    HWY_ALIGN float quads[2][4 * kLanes];
    const auto value = [&](int plane) HWY_ATTR { return hn::Load(f, piece.values[plane]); };
    hn::StoreInterleaved4(value(0), value(1), value(2), hn::Zero(f), f, quads[0]);
    hn::StoreInterleaved4(value(3), value(4), value(5), hn::Set(f, 1.0f), f, quads[1]);
    float* const to = lattice.quads + 8 * lattice.index(0, 0, column, row);
    for (std::size_t i = 0; i < kLanes; ++i)
        for (std::size_t half = 0; half < 2; ++half)
            std::copy_n(quads[half] + 4 * i, 4, to + 8 * i + 4 * half);
}

void take_apart_row(const Frame& frame, const Lattice& lattice, std::int32_t row, Piece& piece) {
    const F f;
    const Layout& layout = frame.layout;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(f));
    const std::int32_t wanted = lanes * lattice.side;
    const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
    const auto put = [&](std::int32_t first_plane, std::int32_t at, const V3& value) HWY_ATTR {
        hn::Store(value.x, f, piece.values[first_plane] + at);
        hn::Store(value.y, f, piece.values[first_plane + 1] + at);
        hn::Store(value.z, f, piece.values[first_plane + 2] + at);
    };
    for (std::int32_t column = 0; column < lattice.width; column += lanes) {
        const std::int32_t first = column * lattice.side, count = std::min(wanted, layout.width - first);
        // Beyond the row's end lie the border and the next row: written to the pictures' borders, see below.
        deal(lattice, frame.depth + layout.index(first, row), lattice.depth, column, row);
        const auto source = [&](const StridedPixels<const float>& from) -> const float* {
            if (from.packed(3) && count == wanted)
                return from.at(static_cast<std::size_t>(first), static_cast<std::size_t>(row));
            load_piece(from, first, count, wanted, row, piece.loaded);
            return piece.loaded;
        };
        const float* const normals = frame.normals ? source(frame.normals) : nullptr;
        for (std::int32_t at = 0; at < wanted; at += lanes) {
            const V3 n = normals ? given_normals(frame, normals + 3 * at, first + at, row)
                                 : derived_normals(frame, first + at, row);
            put(0, at, turned(frame, n, first + at, row));
        }
        for (std::int32_t i = 0; i < 3; ++i)
            deal(lattice, piece.values[i], lattice.normals + i * plane, column, row);
        if (!lattice.radiance && !lattice.quads) continue;
        const float* const radiance = source(frame.radiance);
        const V zero = hn::Zero(f);
        for (std::int32_t at = 0; at < wanted; at += lanes) {
            V3 light;
            hn::LoadInterleaved3(f, radiance + 3 * at, light.x, light.y, light.z);
            const auto some = [&](V v) HWY_ATTR { return hn::IfThenElseZero(hn::Gt(v, zero), v); };
            put(3, at, {some(light.x), some(light.y), some(light.z)});
        }
        if (lattice.quads) {
            put_quads(lattice, piece, column, row);
            continue;
        }
        for (std::int32_t i = 0; i < 3; ++i)
            deal(lattice, piece.values[3 + i], lattice.radiance + i * plane, column, row);
    }
    const std::int32_t y = row % lattice.side, row_there = row / lattice.side;
    for (std::int32_t x = 0; x < lattice.side; ++x) {
        const std::int32_t width = (layout.width - x + lattice.side - 1) / lattice.side;
        std::fill_n(lattice.depth + lattice.index(x, y, -Lattice::kBorder, row_there), Lattice::kBorder,
                    kSky);
        std::fill(lattice.depth + lattice.index(x, y, width, row_there),
                  lattice.depth + lattice.index(x, y, -Lattice::kBorder, row_there + 1), kSky);
    }
}

void take_apart(const Frame& frame, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    Piece piece;
    for (std::int32_t row = begin; row < end; ++row) take_apart_row(frame, lattice, row, piece);
}

#else
void take_apart(const Frame&, const Lattice&, std::int32_t, std::int32_t) {
}  // nobody has a use for a lattice
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(take_apart);

TakeApartFunction* take_apart_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(take_apart), targets, static_cast<TakeApartFunction*>(nullptr));
}

void surround(const Frame& frame, const Lattice& lattice) {
    for (std::int32_t y = 0; y < lattice.side; ++y)
        for (std::int32_t x = 0; x < lattice.side; ++x) {
            float* const picture = lattice.depth + lattice.index(x, y, -Lattice::kBorder, -1);
            const std::int32_t height = (frame.layout.height - y + lattice.side - 1) / lattice.side;
            std::fill_n(picture, lattice.stride, kSky);
            std::fill(picture + (height + 1) * lattice.stride, picture + lattice.picture, kSky);
            // A place that no column has.
            if (x >= frame.layout.width) std::fill_n(picture, lattice.picture, kSky);
        }
}

}  // namespace dfield::runtime::screen
#endif
