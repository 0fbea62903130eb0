// The peer of distance fields, and what the chapters are written with.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "bench/common/asked.hpp"
#include "bench/common/machine.hpp"
#include "bench/volume/openvdb_peer.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using Catch::Contains;

TEST_CASE("OpenVDB as a peer: distances of a sphere of bytes", "[bench]") {
    if (volumes::openvdb_version().empty())
        return test::skip("no OpenVDB in this build (libopenvdb-dev, libboost-dev)");
    const models::ScalarVolume values = models::sphere_volume({33, 31, 29}, {16, 15, 14}, 9.3);
    const volumes::PeerDistances peer =
        volumes::openvdb_distances(volumes::as_bytes("sphere", values, 10), 0);
    CHECK(peer.seconds > 0);
    REQUIRE(peer.distance.size() == values.values.size());
    for (std::size_t i = 0; i < values.values.size(); ++i) {
        const float truth = -values.values[i];
        if (std::abs(truth) < 5) CHECK(peer.distance[i] == Approx(truth).margin(0.6));
    }
}

TEST_CASE("Bytes of a volume keep their isosurface", "[bench]") {
    const models::ScalarVolume values = models::sphere_volume({20, 20, 20}, {9.3, 9.6, 9.1}, 5);
    const volumes::Subject bytes = volumes::as_bytes("sphere", values, 20);
    for (std::size_t i = 0; i < values.values.size(); ++i)
        if (std::abs(values.values[i]) > 0.05)
            CHECK((static_cast<float>(bytes.volume.data[i]) >= bytes.isovalue) == (values.values[i] >= 0));
}

TEST_CASE("Air around a volume", "[bench]") {
    const volumes::Subject matter =
        volumes::as_floats("slab", models::slab_volume({3, 4, 5}, {1, 1, 1}, {0, 0, 1}, 9));
    const volumes::Subject subject = volumes::padded(matter, 2);
    REQUIRE(subject.volume.grid.size == std::array<std::size_t, 3>{7, 8, 9});
    const auto inner = matter.volume.voxels<float>(), all = subject.volume.voxels<float>();
    const float air = *std::min_element(inner.begin(), inner.end());
    std::size_t i = 0;
    for (std::size_t z = 0; z < 9; ++z)
        for (std::size_t y = 0; y < 8; ++y)
            for (std::size_t x = 0; x < 7; ++x, ++i) {
                const bool within = x >= 2 && x < 5 && y >= 2 && y < 6 && z >= 2 && z < 7;
                CHECK(all[i] == (within ? inner[x - 2 + 3 * (y - 2 + 4 * (z - 2))] : air));
            }
}

TEST_CASE("Asked against measured: limits, aims and what is missing", "[bench]") {
    bench::AskedTable table("figure");
    const bench::Bound at_most{false, 10, 5, "%.1f s"}, at_least{true, 2, {}, "%.2f ×"};
    table.row("a", at_most, 10);
    table.row("b", at_most, 4.9);
    table.row("c", at_most, 10.01);
    table.row("d", at_least, 1.99);
    table.missing("e", at_least, "no scan");
    const std::string text = table.table().markdown();
    CHECK_THAT(text, Contains("| a | ≤ 10.0 s | ≤ 5.0 s | 10.0 s | yes |"));
    CHECK_THAT(text, Contains("| b | ≤ 10.0 s | ≤ 5.0 s | 4.9 s | aim |"));
    CHECK_THAT(text, Contains("| c | ≤ 10.0 s | ≤ 5.0 s | 10.0 s | **no** |"));
    CHECK_THAT(text, Contains("| d | ≥ 2.00 × | – | 1.99 × | **no** |"));
    CHECK_THAT(text, Contains("| e | ≥ 2.00 × | – | **not measured** | no scan |"));
}

TEST_CASE("Two threads do neither next to nothing nor more than three can", "[bench]") {
    const double gain = bench::gain_of_two_threads();
    CHECK(gain > 0.3);
    CHECK(gain < 3);
}
