#include "format/hemisphere_map.hpp"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "tests/random.hpp"

using namespace dfield;
using dfield::test::Random;

namespace {
constexpr Mapping kMappings[] = {Mapping::kConcentric, Mapping::kPolar, Mapping::kRejection};
}

TEST_CASE("Every texel's direction falls into that texel") {
    for (const Mapping mapping : kMappings)
        for (const std::uint32_t m : {1u, 2u, 3u, 8u, 31u, 32u, 64u, 200u}) {
            std::size_t wrong = 0, used = 0;
            for (std::uint32_t t = 0; t < m; ++t)
                for (std::uint32_t s = 0; s < m; ++s) {
                    const glm::vec3 w = texel_direction(mapping, m, s, t);
                    if (w.z < 0) continue;  // rejection: unused
                    ++used;
                    wrong += direction_texel(mapping, m, w) != t * m + s;
                }
            CHECK(wrong == 0);
            CHECK(used > 0);
        }
}

TEST_CASE("Directions are unit, on the upper hemisphere, and rejection leaves a fifth unused") {
    for (const Mapping mapping : kMappings) {
        const auto directions = map_directions(mapping, 64);
        std::size_t unused = 0;
        for (const glm::vec3& w : directions) {
            if (w.z < 0) {
                ++unused;
                continue;
            }
            CHECK(std::fabs(glm::length(glm::dvec3(w)) - 1) < 2e-7);
        }
        if (mapping == Mapping::kRejection)
            CHECK(unused / 4096.0 == Approx(0.215).margin(0.01));  // the paper: about 21.5 %
        else
            CHECK(unused == 0);
    }
}

TEST_CASE("Every direction of the hemisphere gets a used texel whose direction is near") {
    Random random(4);
    for (const Mapping mapping : kMappings)
        for (const std::uint32_t m : {2u, 5u, 32u}) {
            double worst = 0;
            for (int i = 0; i < 200000; ++i) {
                glm::vec3 w = random.direction();
                w.z = std::fabs(w.z);
                const std::uint32_t texel = direction_texel(mapping, m, w);
                REQUIRE(texel < m * m);
                const glm::vec3 centre = texel_direction(mapping, m, texel % m, texel / m);
                REQUIRE(centre.z >= 0);
                // On the disk, where all mappings but the polar live.
                worst = std::max(worst, std::hypot(static_cast<double>(w.x - centre.x),
                                                   static_cast<double>(w.y - centre.y)));
            }
            const double cell = 2.0 / m;
            CHECK(worst < (mapping == Mapping::kPolar ? 3.2 : 1.6) * cell);
        }
}

TEST_CASE("Concentric and rejection texels hold equal shares of the cosine-weighted hemisphere") {
    Random random(5);
    constexpr std::uint32_t m = 8;
    for (const Mapping mapping : {Mapping::kConcentric, Mapping::kRejection}) {
        std::vector<double> share(m * m);
        constexpr int kSamples = 640000;
        for (int i = 0; i < kSamples; ++i) ++share[direction_texel(mapping, m, random.cosine_direction())];
        for (std::uint32_t texel = 0; texel < m * m; ++texel) {
            const glm::vec3 centre = texel_direction(mapping, m, texel % m, texel / m);
            // 5 standard deviations of the count; rejection cells at the rim are cut or take what falls
            // outside.
            if (mapping == Mapping::kConcentric)
                CHECK(share[texel] == Approx(kSamples / 64.0).margin(500));
            else if (std::hypot(centre.x, centre.y) < 1 - 3.0 / m && centre.z >= 0)
                CHECK(share[texel] == Approx(kSamples / (64 * 0.7853981634)).margin(600));
        }
    }
}

TEST_CASE("The concentric map keeps area") {
    // Jacobian by central differences: pi/4 everywhere (square of area 4 onto a disk of area pi).
    Random random(6);
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec2 p(random.uniform(-0.999, 0.999), random.uniform(-0.999, 0.999));
        if (std::fabs(std::fabs(p.x) - std::fabs(p.y)) < 1e-2) continue;  // the crease between sectors
        const double h = 1e-5;
        const glm::dvec2 du = (concentric_disk({p.x + h, p.y}) - concentric_disk({p.x - h, p.y})) / (2 * h);
        const glm::dvec2 dv = (concentric_disk({p.x, p.y + h}) - concentric_disk({p.x, p.y - h})) / (2 * h);
        CHECK(du.x * dv.y - du.y * dv.x == Approx(0.7853981634).epsilon(1e-5));
    }
}

TEST_CASE("Cosine directions integrate cosine-weighted functions") {
    for (const std::uint32_t count : {1u, 16u, 100u, 200u, 256u, 1000u, 4096u}) {
        const auto directions = cosine_directions(count);
        REQUIRE(directions.size() == count);
        glm::dvec3 mean(0);
        double z2 = 0;
        for (const glm::vec3& w : directions) {
            mean += glm::dvec3(w) / static_cast<double>(count);
            z2 += static_cast<double>(w.z) * w.z / count;
        }
        // E[x] = E[y] = 0, E[z] = 2/3, E[z^2] = 1/2 under the density cos/pi.
        const double tolerance = count == 1 ? 0.6 : 1.5 / count + 0.004;
        CHECK(std::fabs(mean.x) < tolerance);
        CHECK(std::fabs(mean.y) < tolerance);
        CHECK(mean.z == Approx(2.0 / 3).margin(tolerance));
        CHECK(z2 == Approx(0.5).margin(tolerance));
    }
}

TEST_CASE("Polar directions with their weights integrate the same") {
    std::vector<float> weights;
    const auto directions = polar_directions(256, weights);
    REQUIRE(weights.size() == 256);
    double sum = 0, z = 0, z2 = 0;
    for (std::size_t i = 0; i < 256; ++i) {
        sum += weights[i];
        z += static_cast<double>(weights[i]) * directions[i].z;
        z2 += static_cast<double>(weights[i]) * directions[i].z * directions[i].z;
    }
    CHECK(sum == Approx(1).margin(1e-5));
    CHECK(z == Approx(2.0 / 3).margin(0.003));
    CHECK(z2 == Approx(0.5).margin(0.003));
}
