// Evaluation of octants, a vector of voxels at a time: the closed form of G_s(N) (octant_geometry.cpp) with
// arcs by a polynomial.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/evaluate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "simd.hpp"
#include "volume/evaluate.hpp"
#include "volume/field.hpp"
#include "volume/octant_geometry.hpp"
#include "volume/row_gradient-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// atan2(y, x) for y, x >= 0, not both 0, within 2e-4 (Abramowitz and Stegun 4.4.47 without its last terms).
template<class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V arc(Tag tag, V y, V x) {
    const V high = hn::Max(hn::Max(x, y), hn::Set(tag, 1e-20f));
    const V t = hn::Mul(hn::Min(x, y), hn::ApproximateReciprocal(high)), s = hn::Mul(t, t);
    V p = hn::MulAdd(s, hn::Set(tag, 0.0208351f), hn::Set(tag, -0.0851330f));
    p = hn::MulAdd(s, p, hn::Set(tag, 0.1801410f));
    p = hn::MulAdd(s, p, hn::Set(tag, -0.3302995f));
    p = hn::Mul(t, hn::MulAdd(s, p, hn::Set(tag, 0.9998660f)));
    return hn::IfThenElse(hn::Gt(y, x), hn::Sub(hn::Set(tag, 1.5707963f), p), p);
}

void evaluate_row(const EvaluationJob& job, std::size_t y, std::size_t z) {
    constexpr float kPi = 3.14159265f;
    const Grid& grid = job.grid;
    const std::size_t first = grid.index(0, y, z);
    const auto* const low = job.octants + 4 * first;
    const auto* const high = low + 4 * grid.size();
    const bool even =
        std::all_of(job.intensities.begin(), job.intensities.end(), [](float i) { return i == 1; });
    const RowGradient row(grid, job.distance, y, z);
    row.for_vertices([&](auto tag, std::size_t x) HWY_ATTR {
        using V = hn::Vec<decltype(tag)>;
        const hn::RebindToUnsigned<decltype(tag)> u32;
        const hn::RebindToSigned<decltype(tag)> i32;
        const hn::Repartition<std::uint8_t, decltype(tag)> u8;
        float* const out = job.visibility + first + x;
        const auto words_low = hn::BitCast(u32, hn::LoadU(u8, low + 4 * x));
        const auto words_high = hn::BitCast(u32, hn::LoadU(u8, high + 4 * x));
        const auto all_ones = hn::Set(u32, ~0u);
        if (even && hn::AllTrue(u32, hn::Eq(hn::And(words_low, words_high), all_ones)))
            return hn::StoreU(hn::Set(tag, 1.0f), tag, out);
        if (hn::AllTrue(u32, hn::Eq(hn::Or(words_low, words_high), hn::Zero(u32))))
            return hn::StoreU(hn::Zero(tag), tag, out);

        const auto gradient = row.at(tag, x);
        const auto some = hn::Gt(gradient.square, hn::Zero(tag));
        const V scale = hn::Div(hn::Set(tag, 1.0f), hn::Sqrt(gradient.square));
        const auto unit = [&](V g) HWY_ATTR { return hn::IfThenElseZero(some, hn::Mul(g, scale)); };
        const V n[3] = {unit(gradient.x), unit(gradient.y), unit(gradient.z)};
        // Two zeros have no angle; that of two equal small components serves everything that multiplies it.
        const auto size = [&](V v) HWY_ATTR { return hn::Max(hn::Abs(v), hn::Set(tag, 1e-6f)); };
        const V a = size(n[0]), b = size(n[1]), c = size(n[2]);

        // Light by octant; then, after three conditional swaps, by which of the octant's axes lie opposite to
        // N.
        V light[kOctants];
        for (std::size_t s = 0; s < kOctants; ++s) {
            const auto word = s < 4 ? words_low : words_high;
            const auto byte =
                hn::And(hn::ShiftRightSame(word, static_cast<int>(8 * (s % 4))), hn::Set(u32, 0xff));
            const float weight = job.intensities[s] / (255 * kPi * (job.through ? 2 : 1));
            light[s] = hn::Mul(hn::ConvertTo(tag, hn::BitCast(i32, byte)), hn::Set(tag, weight));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto positive = hn::Ge(n[axis], hn::Zero(tag));
            for (std::size_t s = 0; s < kOctants; ++s)
                if ((s >> axis & 1) == 0) {
                    const V negative_side = light[s], positive_side = light[s | 1u << axis];
                    light[s] = hn::IfThenElse(positive, positive_side, negative_side);
                    light[s | 1u << axis] = hn::IfThenElse(positive, negative_side, positive_side);
                }
        }
        if (job.through)  // G_s(N) + G_s(-N)
            for (std::size_t s = 0; s < kOctants / 2; ++s)
                light[s] = light[kOctants - 1 - s] = hn::Add(light[s], light[kOctants - 1 - s]);

        const V ab = arc(tag, a, b), ac = arc(tag, a, c), bc = arc(tag, b, c);
        const V right = hn::Set(tag, kPi / 2), half = hn::Set(tag, 0.5f);
        const V ba = hn::Sub(right, ab), ca = hn::Sub(right, ac), cb = hn::Sub(right, bc);
        const auto corner = [&](V circle, V p, V arc_p, V q, V arc_q) HWY_ATTR {
            return hn::Mul(half, hn::NegMulAdd(p, arc_p, hn::NegMulAdd(q, arc_q, circle)));
        };
        const V corners[3] = {corner(arc(tag, a, hn::Mul(b, c)), c, ab, b, ac),
                              corner(arc(tag, b, hn::Mul(a, c)), c, ba, a, bc),
                              corner(arc(tag, c, hn::Mul(a, b)), b, ca, a, cb)};
        const V sizes[3] = {a, b, c};
        const V all = hn::Mul(hn::Set(tag, kPi / 4), hn::Add(hn::Add(a, b), c));
        V sum = hn::Mul(all, hn::Add(hn::Add(light[0], light[1]), hn::Add(light[2], light[4])));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const V one = light[1u << axis], two = light[7u ^ 1u << axis];
            sum = hn::MulAdd(corners[axis], hn::Add(one, two), sum);
            sum = hn::NegMulAdd(hn::Mul(right, sizes[axis]), one, sum);
        }
        // Where there is no normal all octants count the same.
        V mean = light[0];
        for (std::size_t s = 1; s < kOctants; ++s) mean = hn::Add(mean, light[s]);
        mean = hn::Mul(mean, hn::Set(tag, kPi / 8));
        hn::StoreU(hn::Max(hn::Zero(tag), hn::IfThenElse(some, sum, mean)), tag, out);
    });
}

void evaluate(const EvaluationJob& job) {
    job.context->for_ranges(job.grid.ny * job.grid.nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            evaluate_row(job, row % job.grid.ny, row / job.grid.ny);
    });
}

#else
void evaluate(const EvaluationJob& job) {
    evaluate_reference(job);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(evaluate);

EvaluationFunction* evaluation_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(evaluate), targets, &evaluate_reference);
}

void evaluate_reference(const EvaluationJob& job) {
    const Grid& grid = job.grid;
    const SignedField field{grid, job.distance};
    job.context->for_ranges(grid.ny * grid.nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            for (std::size_t x = 0; x < grid.nx; ++x) {
                const std::size_t y = row % grid.ny, z = row / grid.ny, i = grid.index(x, y, z);
                const glm::vec3 gradient = field.gradient(x, y, z);
                const float length = glm::length(gradient);
                OctantTerms terms;
                terms.fill(1);
                if (length > 0)
                    terms = job.through ? octant_geometry_through(gradient / length)
                                        : octant_geometry(gradient / length);
                float sum = 0, all = 0;
                for (std::size_t s = 0; s < kOctants; ++s) {
                    const float v =
                        static_cast<float>(job.octants[4 * (s / 4 * grid.size() + i) + s % 4]) / 255;
                    sum += job.intensities[s] * v * terms[s];  // equation 4
                    all += terms[s];
                }
                job.visibility[i] = sum / all;
            }
    });
}

void apply_gamma(const dfield_context& context, float gamma, float* visibility, std::size_t count) {
    if (gamma == 1) return;
    context.for_ranges(count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            visibility[i] = gamma == 2 ? std::sqrt(visibility[i]) : std::pow(visibility[i], 1 / gamma);
    });
}

}  // namespace dfield::runtime::volume
#endif
