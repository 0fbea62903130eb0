// Peak memory of a sweep: what goes through the context's hooks, and the outputs.
#include <array>

#include "bench/common/meter.hpp"
#include "bench/volume/jobs.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::array kJobs{Job::kDistance, Job::kCombined, Job::kOctants, Job::kImproved};

}  // namespace

Json measure_memory(Lab& lab) {
    const Subject subject = timed_subject(lab.stock.size(512));
    bench::Meter meter;
    const cli::VolumeSweeper sweeper(subject.name, subject.volume, subject.isovalue, 1, meter.hooks());
    JobOutputs outputs(sweeper.voxels());
    Json figures{{"size", subject.volume.grid.size[0]}};
    for (const Job job : kJobs) {
        meter.peak = meter.held.load();
        outputs.run(sweeper, subject.isovalue, job);
        const double scratch = static_cast<double>(meter.peak) / static_cast<double>(sweeper.voxels());
        figures["jobs"][name_of(job)] = {{"scratch", scratch}, {"outputs", JobOutputs::bytes_a_voxel(job)}};
        if (job == Job::kOctants)
            figures["octants_bytes_a_voxel"] = scratch + static_cast<double>(JobOutputs::bytes_a_voxel(job));
    }
    return figures;
}

void write_memory(const Json& all, bench::Page& page) {
    const Json& figures = all["memory"];
    page.heading(3, "Memory");
    page.paragraph(
        text("Bytes a voxel, %u³, one thread. Scratch is the most that the sweep held at once through the "
             "context's allocation hooks; outputs are the caller's: a float for the distance, eight "
             "bytes for the octants, a float for visibility. The volume itself, here a byte a voxel, "
             "is not counted.",
             figures["size"].get<unsigned>()));
    bench::Table table({"job", "scratch", "outputs", "together"});
    for (const auto& [name, job] : figures["jobs"].items()) {
        const double scratch = job["scratch"], outputs = job["outputs"];
        table.row({name, text("%.2f", scratch), text("%.0f", outputs), text("%.2f", scratch + outputs)});
    }
    page.table(table);
}

}  // namespace dfield::volumes
