// Distances near a sphere, where the truth is known.
#include <algorithm>
#include <array>
#include <cmath>

#include "bench/volume/jobs.hpp"
#include "bench/volume/openvdb_peer.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr double kNear = 5;  // voxels from the surface
constexpr std::array<double, 3> kRadii{20, 34, 45};
constexpr std::uint32_t kSize = 112;

Json error_of(const std::vector<float>& distance, const std::vector<float>& truth) {
    double squares = 0, most = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (std::abs(truth[i]) > kNear) continue;
        const double error = std::abs(double{distance[i]} + double{truth[i]});  // values grow inwards
        squares += error * error;
        most = std::max(most, error);
        ++count;
    }
    return {{"rms", std::sqrt(squares / static_cast<double>(count))}, {"max", most}};
}

}  // namespace

Json measure_sphere(Lab& lab) {
    Json figures{{"rms", 0}, {"openvdb", openvdb_version()}};
    const std::uint32_t n = lab.stock.size(kSize);
    // Off the grid's own symmetry.
    const glm::dvec3 centre = 0.5 * (n - 1.0) + glm::dvec3(0.13, -0.21, 0.37);
    for (const double full : kRadii) {
        const double radius = full * n / kSize;
        const models::ScalarVolume values = models::sphere_volume({n, n, n}, centre, radius);
        const Subject subject = as_floats("sphere", values);
        JobOutputs outputs(values.values.size());
        Json row{{"radius", radius}};
        for (const dfield_simd simd : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR}) {
            const cli::VolumeSweeper sweeper(subject.name, subject.volume, 0, 1, capped(simd));
            outputs.run(sweeper, 0, Job::kDistance);
            row[simd == DFIELD_SIMD_BEST ? "vectorised" : "scalar"] =
                error_of(outputs.distance(), values.values);
        }
        if (!openvdb_version().empty())
            row["openvdb"] = error_of(openvdb_distances(subject, 0).distance, values.values);
        figures["rms"] = std::max(figures["rms"].get<double>(), row["vectorised"]["rms"].get<double>());
        figures["rows"].push_back(row);
    }
    return figures;
}

void write_sphere(const Json& all, bench::Page& page) {
    const Json& figures = all["sphere"];
    page.heading(3, "Distances near a sphere");
    const bool peer = !figures["openvdb"].get<std::string>().empty();
    page.paragraph(
        text("RMS / largest error of the distance, in voxels, at all voxels within %g of the surface; "
             "the volume holds exact distances as floats.",
             kNear) +
        (peer ? "" : " **OpenVDB was not there when this was built: its column is left out.**"));
    std::vector<std::string> columns{"radius, voxels", "vectorised", "scalar reference"};
    if (peer) columns.push_back("OpenVDB " + figures["openvdb"].get<std::string>());
    bench::Table table(columns);
    for (const Json& row : figures["rows"]) {
        std::vector<std::string> cells{text("%.0f", row["radius"].get<double>())};
        for (const char* name : {"vectorised", "scalar", "openvdb"})
            if (row.contains(name))
                cells.push_back(
                    text("%.3f / %.2f", row[name]["rms"].get<double>(), row[name]["max"].get<double>()));
        table.row(cells);
    }
    page.table(table);
}

}  // namespace dfield::volumes
