// Local ambient occlusion against the paper's equations, written out anew, and against itself.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "tests/volume/local_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

std::vector<glm::dvec3> directions_of(const dfield_local_desc& desc) {
    std::vector<float> values(3 * desc.ray_count);
    REQUIRE(dfield_local_get_directions(&desc, values.data()) == DFIELD_OK);
    std::vector<glm::dvec3> directions;
    for (std::size_t k = 0; k < desc.ray_count; ++k)
        directions.emplace_back(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
    return directions;
}

double opacity_of(const Transfer& transfer, double value) {
    const auto& points = transfer.points;
    if (value < points.front().value) return points.front().opacity;
    for (std::size_t i = points.size() - 1; i > 0; --i)
        if (value >= points[i - 1].value && value < points[i].value)
            return points[i - 1].opacity + (value - points[i - 1].value) /
                                               (points[i].value - points[i - 1].value) *
                                               (points[i].opacity - points[i - 1].opacity);
    return points.back().opacity;
}

// Equations 2 and 3 in double, at one voxel.
double by_the_paper(const models::ScalarVolume& volume, const dfield_local_desc& desc,
                    const Transfer& transfer, const glm::dvec3& voxel) {
    const auto opacity = [&](const glm::dvec3& at) {
        double sum = 0;
        const glm::dvec3 low = glm::floor(at), f = at - low;
        for (int corner = 0; corner < 8; ++corner) {
            double weight = 1;
            std::size_t index[3];
            for (int axis = 0; axis < 3; ++axis) {
                const int up = corner >> axis & 1;
                weight *= up ? f[axis] : 1 - f[axis];
                const double i = low[axis] + up;
                if (i < 0 || i >= volume.dims[static_cast<std::size_t>(axis)]) weight = 0;
                index[axis] = static_cast<std::size_t>(std::max(i, 0.0));
            }
            if (weight > 0)
                sum +=
                    weight * opacity_of(transfer, volume.values[volume.index(index[0], index[1], index[2])]);
        }
        return sum;
    };
    const glm::dvec3 spacing(volume.spacing[0], volume.spacing[1], volume.spacing[2]);
    double factor = 0;
    std::size_t k = 0;
    for (const glm::dvec3& direction : directions_of(desc)) {
        glm::dvec3 step = direction * static_cast<double>(desc.step);
        if (desc.step_unit == DFIELD_STEP_WORLD) step /= spacing;
        double sum = 0;
        for (std::uint32_t m = 1; m <= desc.samples; ++m) {
            double product = 1;
            for (std::uint32_t i = 1; i < m; ++i)
                product *= 1 - opacity(voxel + step * static_cast<double>(i));
            sum += product;
        }
        factor += (desc.weights ? desc.weights[k] : 1.0) * sum / desc.samples;
        ++k;
    }
    return factor / desc.ray_count;
}

}  // namespace

TEST_CASE("The paper's ray sets are what it says", "[volume][local]") {
    for (const std::uint32_t count : {6u, 14u, 26u, 54u, 1u, 100u, 512u}) {
        const auto directions = directions_of(local_desc(count));
        REQUIRE(directions.size() == count);
        glm::dvec3 sum(0);
        for (const glm::dvec3& d : directions) {
            CHECK(glm::length(d) == Approx(1).margin(1e-6));
            sum += d;
        }
        if (count > 1) CHECK(glm::length(sum) / count < (count < 55 ? 1e-6 : 0.02));
        for (std::size_t i = 0; i < directions.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) CHECK(glm::distance(directions[i], directions[j]) > 0.05);
    }
    // Stickers of a Rubik's cube: nine a side, at (1, 0 or +-2/3, 0 or +-2/3).
    const auto stickers = directions_of(local_desc(54));
    CHECK(std::count_if(stickers.begin(), stickers.end(), [](const glm::dvec3& d) {
              const glm::dvec3 a = glm::abs(d);
              const double most = std::max({a.x, a.y, a.z});
              return std::abs(most - 1 / std::sqrt(1 + 8.0 / 9)) < 1e-6;
          }) == 24);
}

TEST_CASE("Every level agrees with the paper's equations", "[volume][local]") {
    Random random(5);
    const models::Dims sizes[] = {{1, 1, 1}, {17, 5, 3}, {40, 23, 19}, {33, 16, 9}, {3, 40, 2}, {70, 9, 11}};
    for (const models::Dims& dims : sizes)
        for (int form = 0; form < 4; ++form) {
            const auto volume = blobs(dims, random.below(1000),
                                      form < 2 ? models::kUnitSpacing : models::Spacing{0.8, 1.7, 1.1});
            dfield_local_desc desc = local_desc(form == 0 ? 54 : form == 1 ? 14 : 33, form == 3 ? 1 : 21);
            std::vector<float> weights;
            if (form >= 1) {
                for (std::uint32_t k = 0; k < desc.ray_count; ++k)
                    weights.push_back(static_cast<float>(random.uniform(0, 2)));
                desc.weights = weights.data();
            }
            if (form == 2) desc.step_unit = DFIELD_STEP_WORLD;
            desc.step = form == 0 ? 1.0f : 0.7f;
            const Transfer transfer;
            const std::vector<float> reference = local_ao(volume, desc, transfer, DFIELD_SIMD_SCALAR);
            for (int i = 0; i < 10; ++i) {
                const glm::uvec3 at(random.below(dims[0]), random.below(dims[1]), random.below(dims[2]));
                CHECK(reference[volume.index(at.x, at.y, at.z)] ==
                      Approx(by_the_paper(volume, desc, transfer, at)).margin(1e-5));
            }
            std::vector<float> fused;
            for (const dfield_simd level :
                 {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON}) {
                const std::vector<float> found = local_ao(volume, desc, transfer, level);
                INFO("level " << level << " form " << form << " " << dims[0] << "x" << dims[1]);
                CHECK(largest_difference(found, reference) < 2e-5f);
                const dfield_context_desc how = context_desc(level);
                if (dfield_context_get_simd(Context(&how).get()) != level || level == DFIELD_SIMD_SSE4)
                    continue;
                if (!fused.empty())
                    CHECK(std::memcmp(fused.data(), found.data(), sizeof(float) * found.size()) == 0);
                fused = found;
            }
        }
}

TEST_CASE("Haze and walls have the factors that follow from the equations", "[volume][local]") {
    models::ScalarVolume volume{{60, 60, 60}, {1, 1, 1}, std::vector<float>(60 * 60 * 60, 1.0f)};
    const Transfer haze{{{0, 0}, {1, 0.04f}}};
    const auto visibility = local_ao(volume, local_desc(54, 20), haze);
    const double inside = (1 - std::pow(0.96, 20)) / (0.04 * 20);
    CHECK(visibility[volume.index(30, 30, 30)] == Approx(inside).margin(1e-5));
    // Opacities of a length: half the step, and twice as many samples of the same matter.
    dfield_local_desc fine = local_desc(54, 20);
    fine.step = 0.5f;
    const auto thin = local_ao(volume, fine, Transfer{haze.points, 1});
    CHECK(thin[volume.index(30, 30, 30)] ==
          Approx((1 - std::pow(0.96, 10)) / ((1 - std::sqrt(0.96)) * 20)).margin(1e-5));

    // Opaque matter below z = 30: the rays that do not point below see all.
    for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = i < 30 * 3600 ? 1.0f : 0.0f;
    const auto wall = local_ao(volume, local_desc(6, 20), Transfer{{{0, 0}, {1, 1}}});
    CHECK(wall[volume.index(30, 30, 30)] == Approx((5 + 1.0 / 20) / 6).margin(1e-6));
    CHECK(wall[volume.index(30, 30, 10)] == Approx(1.0 / 20).margin(1e-5));
    CHECK(wall[volume.index(30, 30, 55)] == 1);
    // Unsorted types of samples all lead to the same.
    std::vector<std::uint8_t> bytes(volume.values.begin(), volume.values.end());
    std::vector<std::int16_t> shorts(volume.values.begin(), volume.values.end());
    const Context context;
    dfield_volume_samples samples = samples_of(volume);
    for (const auto& [type, data] : {std::pair<std::uint32_t, const void*>{DFIELD_SAMPLE_U8, bytes.data()},
                                     {DFIELD_SAMPLE_I8, bytes.data()},
                                     {DFIELD_SAMPLE_U16, shorts.data()},
                                     {DFIELD_SAMPLE_I16, shorts.data()}}) {
        samples.type = type;
        samples.data = data;
        CHECK(local_ao(context, samples, local_desc(6, 20), Transfer{{{0, 0}, {1, 1}}}) == wall);
    }
}

TEST_CASE("Local ambient occlusion is the same at any number of threads", "[volume][local]") {
    const auto volume = blobs({75, 43, 50}, 3);
    for (const float jitter : {0.0f, 0.5f}) {
        dfield_local_desc desc = local_desc(jitter > 0 ? 6 : 54, 15);
        desc.jitter = jitter;
        const auto alone = local_ao(volume, desc);
        Threads threads(3);
        dfield_context_desc how = context_desc(DFIELD_SIMD_BEST);
        threads.install(how);
        CHECK(local_ao(Context(&how), samples_of(volume), desc) == alone);
    }
}

TEST_CASE("Jitter turns rays by its seed and keeps the mean", "[volume][local]") {
    const auto volume = blobs({40, 40, 40}, 9);
    const auto mean = [](const std::vector<float>& v) {
        double sum = 0;
        for (const float x : v) sum += static_cast<double>(x);
        return sum / static_cast<double>(v.size());
    };
    dfield_local_desc desc = local_desc(6, 20);
    const auto plain = local_ao(volume, desc), truth = local_ao(volume, local_desc(512, 20));
    desc.jitter = 1;
    const auto jittered = local_ao(volume, desc);
    CHECK(jittered == local_ao(volume, desc, {}, DFIELD_SIMD_SSE4));
    desc.seed = 1;
    const auto other = local_ao(volume, desc);
    CHECK(largest_difference(jittered, other) > 0.05f);
    CHECK(std::abs(mean(jittered) - mean(other)) < 1e-3);
    CHECK(std::abs(mean(jittered) - mean(truth)) < 0.01);
    desc.jitter = 0.1f;
    CHECK(largest_difference(local_ao(volume, desc), plain) < 0.5f * largest_difference(jittered, plain));
}

TEST_CASE("Local ambient occlusion refuses what makes no sense", "[volume][local][api]") {
    auto volume = blobs({9, 8, 7}, 1);
    const Context context;
    std::vector<float> out(9 * 8 * 7);
    const auto refused = [&](const auto& change) {
        dfield_volume_samples samples = samples_of(volume);
        dfield_local_desc desc = local_desc();
        Transfer transfer;
        change(samples, desc, transfer);
        const dfield_opacity_desc opacity = transfer.desc();
        const bool refused = dfield_volume_local_ao(context.get(), &samples, &opacity, &desc, out.data()) ==
                             DFIELD_INVALID_ARGUMENT;
        return refused && std::strlen(dfield_error_message()) > 20;
    };
    CHECK_FALSE(refused([](auto&, auto&, auto&) {}));
    CHECK(refused([](auto& s, auto&, auto&) { s.struct_size = 1; }));
    CHECK(refused([](auto& s, auto&, auto&) { s.data = nullptr; }));
    CHECK(refused([](auto& s, auto&, auto&) { s.grid.dims[0] = 0; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.struct_size = 8; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.ray_count = 7; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.ray_count = 0; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.samples = 0; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.samples = 2000; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.step = NAN; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.step = 1e9f; }));
    CHECK(refused([](auto&, auto& d, auto&) { d.jitter = 2; }));
    CHECK(refused([](auto&, auto&, auto& t) { t.points.clear(); }));
    CHECK(refused([](auto&, auto&, auto& t) { t.points[0].opacity = 1.5f; }));
    CHECK(refused([](auto&, auto&, auto& t) { t.points[1].value = -5; }));
    CHECK(refused([](auto&, auto&, auto& t) { t.unit_length = -1; }));
    CHECK(refused([](auto& s, auto&, auto& t) {
        s.grid.spacing[0] = 2;
        t.unit_length = 1;
    }));
    volume.values[100] = NAN;
    CHECK(refused([](auto&, auto&, auto&) {}));
}
