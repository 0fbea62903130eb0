// The codec by itself: folding, neighbours, and any bytes at all as its input.
#include "format/codec.hpp"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "format/codec_distances.hpp"
#include "format/codec_neighbours.hpp"
#include "format/sphere_points.hpp"
#include "tests/format/fields.hpp"

using namespace dfield;
using namespace dfield::codec;
using namespace dfield::test;

TEST_CASE("folding a residual is a bijection that puts small residuals first") {
    const std::int32_t miss = miss_value(8);
    for (std::int32_t prediction = 0; prediction < miss; ++prediction) {
        std::vector<bool> seen(static_cast<std::size_t>(miss));
        for (std::int32_t value = 0; value < miss; ++value) {
            const std::uint32_t folded = fold_residual(value, prediction, miss);
            REQUIRE(folded < static_cast<std::uint32_t>(miss));
            REQUIRE(!seen[folded]);
            seen[folded] = true;
            REQUIRE(unfold_residual(folded, prediction, miss) == value);
        }
        REQUIRE(fold_residual(prediction, prediction, miss) == 0);
    }
    for (const std::uint32_t bits : {16u, 32u}) {
        const std::int32_t large = miss_value(bits);
        Bits random(bits);
        for (int i = 0; i < 100000; ++i) {
            const auto end = static_cast<std::uint64_t>(large);
            const auto prediction = static_cast<std::int32_t>(random.below(end));
            const std::uint32_t folded = i % 3 == 0   ? random.below(40)
                                         : i % 3 == 1 ? random.below(end)
                                                      : large - 1 - random.below(40);
            const std::int32_t value = unfold_residual(folded, prediction, large);
            REQUIRE(value >= 0);
            REQUIRE(value < large);
            REQUIRE(fold_residual(value, prediction, large) == folded);
        }
    }
    for (std::uint32_t value = 0; value < 65536; value += 13)
        for (std::uint32_t prediction = 0; prediction < 65536; prediction += 509) {
            const auto v = static_cast<std::uint16_t>(value), p = static_cast<std::uint16_t>(prediction);
            REQUIRE(unfold_word(fold_word(v, p), p) == v);
        }
}

TEST_CASE("neighbours come earlier in the file and lie near on the sphere") {
    for (const Positions positions : {Positions::kSlater, Positions::kLatlong})
        for (const std::uint32_t n : {1u, 2u, 7u, 16u}) {
            const FieldParameters p{positions, n, Mapping::kConcentric, 4, 8};
            const auto points = sphere_points(positions, n);
            const auto neighbours = position_neighbours(p, std::pmr::get_default_resource());
            REQUIRE(neighbours.size() == points.size());
            // Rings are at most this far apart; the factor covers the poles of the latitude-longitude grid.
            const double reach = 3.6 / n;
            std::size_t missing = 0;
            for (std::uint32_t i = 0; i < neighbours.size(); ++i)
                for (const std::uint32_t j :
                     {neighbours[i].previous, neighbours[i].above, neighbours[i].beside}) {
                    if (j == Neighbours::kNone) {
                        ++missing;
                        continue;
                    }
                    REQUIRE(j < i);
                    REQUIRE(glm::distance(points[i], points[j]) < reach);
                }
            // One `previous` a ring, and `above` and `beside` on the first.
            const std::size_t first_ring = positions == Positions::kSlater ? 1 : 2 * n + 2;
            CHECK(missing == 2 * n + 1 + 2 * first_ring);
        }
}

TEST_CASE("the hit mask's decoder takes any bytes") {
    const FieldParameters p{Positions::kSlater, 2, Mapping::kConcentric, 11, 1};
    const auto size = static_cast<std::size_t>(plane_bytes(p));
    const std::vector<std::uint8_t> smooth = plane_of_texels(p, make_field(p, Pattern::kSmooth).texels);
    const std::vector<std::byte> encoded = encode_mask(p, smooth);
    std::vector<std::uint8_t> plane(size);
    REQUIRE(decode_mask(p, encoded, plane, std::pmr::get_default_resource()));
    REQUIRE(plane == smooth);
    Bits random(3);
    int decoded = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<std::byte> raw = encoded;
        if (i % 2 == 0) {
            for (int k = 0; k < 3; ++k) raw[random.below(raw.size())] = static_cast<std::byte>(random.next());
        } else {
            raw.resize(random.below(2 * size));
            for (auto& byte : raw) byte = static_cast<std::byte>(random.next());
            if (!raw.empty()) raw[0] = std::byte{1};
        }
        std::fill(plane.begin(), plane.end(), std::uint8_t{0});
        if (!decode_mask(p, raw, plane, std::pmr::get_default_resource())) continue;
        ++decoded;
        for (std::size_t end = 2; end <= size; end += 2)
            REQUIRE(plane[end - 1] >> 3 == 0);  // padding of 11 bits
    }
    CHECK(decoded < 100);  // the end of the stream tells most of them
}

TEST_CASE("the distances' decoder takes any bytes and gives valid texels only") {
    for (const std::uint32_t bits : {8u, 16u, 32u}) {
        const FieldParameters p{Positions::kSlater, 2, Mapping::kConcentric, 6, bits};
        const DisplacementField field = make_field(p, Pattern::kNoise);
        const std::vector<std::uint8_t> plane = plane_of_texels(p, field.texels);
        const std::vector<std::byte> encoded = encode_distances(p, plane, field.texels).raw;
        std::vector<std::uint8_t> texels(texel_bytes(p));
        REQUIRE(decode_distances(p, encoded, plane, texels, std::pmr::get_default_resource()));
        REQUIRE(std::equal(texels.begin(), texels.end(), field.texels.begin(), field.texels.end()));
        Bits random(bits);
        int decoded = 0;
        for (int i = 0; i < 600; ++i) {
            std::vector<std::byte> raw = encoded;
            const std::size_t counts = 4 * context_count(bits);
            for (int k = 0; k < 4; ++k)
                raw[counts + random.below(raw.size() - counts)] = static_cast<std::byte>(random.next());
            if (i % 5 == 0) raw[random.below(counts)] = static_cast<std::byte>(random.next());
            if (i % 7 == 0) raw.resize(random.below(raw.size()));
            if (!decode_distances(p, raw, plane, texels, std::pmr::get_default_resource())) continue;
            ++decoded;
            REQUIRE(plane_of_texels(p, texels) == plane);
            if (bits == 32)
                for (std::size_t k = 0; k < texels.size(); k += 4) {
                    const std::uint32_t value = load_le<std::uint32_t>(&texels[k]);
                    REQUIRE(value <= std::bit_cast<std::uint32_t>(kMiss32));
                }
        }
        CHECK(decoded > 0);
    }
}
