// Peak memory of a sweep: what goes through the context's hooks, and the outputs.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>

#include "bench/volume/jobs.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::array kJobs{Job::kDistance, Job::kCombined, Job::kOctants, Job::kImproved};

// Allocator hooks that know how much was held at most.
struct Meter {
    std::atomic<std::size_t> held{0}, peak{0};

    dfield_context_desc hooks() {
        dfield_context_desc desc{};
        desc.user = this;
        desc.allocate = [](void* user, std::size_t size, std::size_t alignment) {
            Meter& meter = *static_cast<Meter*>(user);
            const std::size_t now = meter.held += size;
            for (std::size_t peak = meter.peak; now > peak && !meter.peak.compare_exchange_weak(peak, now);)
                ;
            return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
        };
        desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t) {
            static_cast<Meter*>(user)->held -= size;
            std::free(memory);
        };
        return desc;
    }
};

}  // namespace

Json measure_memory(Lab& lab) {
    const Subject subject = timed_subject(lab.stock.size(512));
    Meter meter;
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
