// How times change with the volume's size, on the bonsai, and with a second thread.
#include <array>

#include "bench/common/machine.hpp"
#include "bench/common/turns.hpp"
#include "bench/volume/jobs.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::array kJobs{Job::kDistance, Job::kOctants, Job::kImproved};

double voxels(const Subject& subject) {
    return static_cast<double>(subject.volume.grid.voxels());
}

}  // namespace

Json measure_bonsai(Lab& lab) {
    const Subject* bonsai = lab.stock.shared("bonsai");
    if (!bonsai) return Json::object();
    constexpr std::array kBonsaiJobs{Job::kDistance, Job::kCombined, Job::kOctants, Job::kPaper,
                                     Job::kImproved};
    const std::vector<double> seconds = job_seconds(*bonsai, kBonsaiJobs, lab.stock.rounds(7));
    Json figures{{"isovalue", bonsai->isovalue}};
    for (std::size_t i = 0; i < kBonsaiJobs.size(); ++i)
        figures["rates"][name_of(kBonsaiJobs[i])] = 1e-6 * voxels(*bonsai) / seconds[i];
    figures["rate_paper"] = figures["rates"][name_of(Job::kPaper)];
    return figures;
}

void write_bonsai(const Json& all, bench::Page& page) {
    const Json& figures = all["bonsai"];
    page.heading(3, "A real volume");
    if (figures.empty())
        return page.paragraph("**The bonsai was not there: its row and its table are left out.**");
    page.paragraph(
        text("The bonsai, 256³ bytes, isovalue %g, one core, from its bytes to what the column "
             "says. \"All in\" above is the paper's form with distances, eight octants and the "
             "visibility that these give with the gradient as normal.",
             figures["isovalue"].get<double>()));
    std::vector<std::string> names{"bonsai"}, cells{"million voxels a second"};
    for (const auto& [name, rate] : figures["rates"].items()) {
        names.push_back(name);
        cells.push_back(text("%.0f", rate.get<double>()));
    }
    bench::Table table(names);
    table.row(cells);
    page.table(table);
}

Json measure_scale(Lab& lab) {
    const Subject small = timed_subject(lab.stock.size(128)), large = timed_subject(lab.stock.size(512));
    const cli::VolumeSweeper on_small(small.name, small.volume, small.isovalue, 1),
        on_large(large.name, large.volume, large.isovalue, 1);
    JobOutputs few(on_small.voxels()), many(on_large.voxels());
    std::vector<std::function<void()>> contestants;
    for (const Job job : kJobs) {
        contestants.push_back([&, job] { few.run(on_small, small.isovalue, job); });
        contestants.push_back([&, job] { many.run(on_large, large.isovalue, job); });
    }
    const std::vector<double> seconds = bench::fastest_turns(contestants, lab.stock.rounds(3));
    Json figures{{"sizes", {small.volume.grid.size[0], large.volume.grid.size[0]}}, {"ratio", 0}};
    for (std::size_t i = 0; i < kJobs.size(); ++i) {
        const double a = 1e9 * seconds[2 * i] / voxels(small), b = 1e9 * seconds[2 * i + 1] / voxels(large);
        figures["jobs"][name_of(kJobs[i])] = {{"small_ns", a}, {"large_ns", b}, {"ratio", b / a}};
        figures["ratio"] = std::max(figures["ratio"].get<double>(), b / a);
    }
    return figures;
}

void write_scale(const Json& all, bench::Page& page) {
    const Json& figures = all["scale"];
    const std::string small = text("ns a voxel, %u³", figures["sizes"][0].get<unsigned>()),
                      large = text("ns a voxel, %u³", figures["sizes"][1].get<unsigned>());
    page.heading(3, "Size of the volume");
    bench::Table table({"job", small, large, "×"});
    for (const auto& [name, job] : figures["jobs"].items())
        table.row({name, text("%.2f", job["small_ns"].get<double>()),
                   text("%.2f", job["large_ns"].get<double>()), text("%.2f", job["ratio"].get<double>())});
    page.table(table);
}

Json measure_threads(Lab& lab) {
    const Subject subject = timed_subject(lab.stock.size(250));
    const cli::VolumeSweeper on_one(subject.name, subject.volume, subject.isovalue, 1),
        on_two(subject.name, subject.volume, subject.isovalue, 2);
    JobOutputs outputs(on_one.voxels());
    std::vector<std::function<void()>> contestants;
    for (const Job job : kJobs)
        for (const cli::VolumeSweeper* sweeper : {&on_one, &on_two})
            contestants.push_back([&, job, sweeper] { outputs.run(*sweeper, subject.isovalue, job); });
    const std::vector<double> seconds = bench::fastest_turns(contestants, lab.stock.rounds(7));
    Json figures{
        {"size", subject.volume.grid.size[0]}, {"arithmetic", bench::gain_of_two_threads()}, {"ratio", 1e9}};
    for (std::size_t i = 0; i < kJobs.size(); ++i) {
        const double ratio = seconds[2 * i] / seconds[2 * i + 1];
        figures["jobs"][name_of(kJobs[i])] = {
            {"one", seconds[2 * i]}, {"two", seconds[2 * i + 1]}, {"ratio", ratio}};
        figures["ratio"] = std::min(figures["ratio"].get<double>(), ratio);
    }
    return figures;
}

void write_threads(const Json& all, bench::Page& page) {
    constexpr double kTwoCores = 1.6;
    const Json& figures = all["threads"];
    const double arithmetic = figures["arithmetic"];
    page.heading(3, "Two threads");
    page.paragraph(
        text("%u³. Two threads of this machine do %.2f times the arithmetic of one (a loop of "
             "multiplications and additions in registers alone)",
             figures["size"].get<unsigned>(), arithmetic) +
        (arithmetic < kTwoCores
             ? ": **they are two hyperthreads of one core, not two cores, and what two cores would "
               "gain was not measured.**"
             : ": they are two cores."));
    bench::Table table({"job", "one thread, s", "two threads, s", "×"});
    for (const auto& [name, job] : figures["jobs"].items())
        table.row({name, text("%.4f", job["one"].get<double>()), text("%.4f", job["two"].get<double>()),
                   text("%.2f", job["ratio"].get<double>())});
    page.table(table);
}

}  // namespace dfield::volumes
