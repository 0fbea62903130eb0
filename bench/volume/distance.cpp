// The distance field against OpenVDB's and against the scalar reference, in one run on one volume.
#include <array>

#include "bench/common/turns.hpp"
#include "bench/volume/jobs.hpp"
#include "bench/volume/openvdb_peer.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {

using cli::text;

Json measure_distance(Lab& lab) {
    const std::uint32_t size = lab.stock.size(250);
    const Subject subject = timed_subject(size);
    const cli::VolumeSweeper best(subject.name, subject.volume, subject.isovalue, 1);
    const cli::VolumeSweeper scalar(subject.name, subject.volume, subject.isovalue, 1,
                                    capped(DFIELD_SIMD_SCALAR));
    JobOutputs outputs(best.voxels());
    const auto ours = [&] { outputs.run(best, subject.isovalue, Job::kDistance); };
    Json figures{{"size", size}};
    double seconds = bench::fastest_turns(std::array<std::function<void()>, 1>{ours}, lab.stock.rounds(5))[0];
    if (const std::string version = openvdb_version(); !version.empty()) {
        const double peer = openvdb_distances(subject, lab.stock.quick() ? 0 : 5).seconds;
        figures["openvdb"] = version;
        figures["openvdb_seconds"] = peer;
        seconds = std::min(seconds, bench::seconds_of(ours));
        figures["against_openvdb"] = peer / seconds;
    }
    const double reference =
        bench::seconds_of([&] { outputs.run(scalar, subject.isovalue, Job::kDistance); });
    seconds = std::min(seconds, bench::seconds_of(ours));
    figures["scalar_seconds"] = reference;
    figures["against_scalar"] = reference / seconds;
    figures["seconds"] = seconds;
    return figures;
}

void write_distance(const Json& all, bench::Page& page) {
    const Json& figures = all["distance"];
    const auto seconds = [&](const char* name) { return text("%.3g s", figures[name].get<double>()); };
    const auto size = figures["size"].get<unsigned>();
    std::string peer =
        "**OpenVDB was not there when this was built (libopenvdb-dev, libboost-dev): the comparison with it "
        "is left out.**";
    if (figures.contains("openvdb"))
        peer =
            "OpenVDB " + figures["openvdb"].get<std::string>() + "'s `fogToSdf` takes " +
            seconds("openvdb_seconds") +
            " in one thread for the same volume, all voxels active, one round of eight sweeps, its grid of "
            "floats made beforehand and its result not copied out.";
    page.heading(3, "The distance field");
    page.paragraph(
        text("A gyroid of %g periods in bytes, %u³, from these bytes to signed distances as floats: "
             "%s; the scalar reference, which reads like the paper, %s. ",
             kGyroidPeriods, size, seconds("seconds").c_str(), seconds("scalar_seconds").c_str()) +
        peer);
}

}  // namespace dfield::volumes
