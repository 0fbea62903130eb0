#include "bench/volume/jobs.hpp"

#include "bench/common/turns.hpp"

namespace dfield::volumes {
namespace {

struct Wanted {
    dfield_occlusion_form form;
    bool visibility, octants;
};

Wanted wanted(Job job) {
    switch (job) {
        case Job::kCombined:
            return {DFIELD_FORM_COMBINED, true, false};
        case Job::kOctants:
            return {DFIELD_FORM_PAPER, false, true};
        case Job::kPaper:
            return {DFIELD_FORM_PAPER, true, true};
        case Job::kImproved:
            return {DFIELD_FORM_IMPROVED, true, false};
        case Job::kDistance:
            break;
    }
    return {DFIELD_FORM_PAPER, false, false};
}

}  // namespace

const char* name_of(Job job) {
    switch (job) {
        case Job::kCombined:
            return "combined";
        case Job::kOctants:
            return "8 octants";
        case Job::kPaper:
            return "8 octants and visibility";
        case Job::kImproved:
            return "improved";
        case Job::kDistance:
            break;
    }
    return "distance";
}

JobOutputs::JobOutputs(std::size_t voxels)
    : distance_(voxels, 1.0f), visibility_(voxels, 1.0f), octants_(8 * voxels, 1) {}

void JobOutputs::run(const cli::VolumeSweeper& sweeper, float isovalue, Job job) {
    const Wanted want = wanted(job);
    dfield_sweep_desc desc = sweep_defaults();
    desc.isovalue = isovalue;
    desc.form = want.form;
    dfield_sweep_outputs outputs = no_sweep_outputs();
    outputs.distance = distance_.data();
    if (want.visibility) outputs.visibility = visibility_.data();
    if (want.octants) outputs.octants = octants_.data();
    sweeper.sweep(desc, outputs);
}

std::size_t JobOutputs::bytes_a_voxel(Job job) {
    const Wanted want = wanted(job);
    return sizeof(float) * (want.visibility ? 2 : 1) + (want.octants ? 8 : 0);
}

dfield_context_desc capped(dfield_simd simd) {
    dfield_context_desc hooks{};
    hooks.simd = static_cast<std::uint32_t>(simd);
    return hooks;
}

std::vector<double> job_seconds(const Subject& subject, std::span<const Job> jobs, int rounds) {
    const cli::VolumeSweeper sweeper(subject.name, subject.volume, subject.isovalue, 1);
    JobOutputs outputs(sweeper.voxels());
    std::vector<std::function<void()>> contestants;
    for (const Job job : jobs)
        contestants.push_back([&, job] { outputs.run(sweeper, subject.isovalue, job); });
    return bench::fastest_turns(contestants, rounds);
}

}  // namespace dfield::volumes
