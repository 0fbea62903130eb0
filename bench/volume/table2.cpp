// Table 2: what occlusion adds to the distance sweeps, by the volume's size.
#include <algorithm>
#include <array>
#include <optional>

#include "bench/volume/jobs.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::array kJobs{Job::kDistance, Job::kCombined, Job::kOctants, Job::kImproved};

// An Intel Core 2 of 2.66 GHz, seconds.
struct PaperRow {
    models::Dims dims;
    double distance, combined, octants;
};
constexpr std::array<PaperRow, 5> kPaper{{{{101, 101, 61}, 0.72, 0.91, 1.01},
                                          {{100, 100, 100}, 1.06, 1.386, 1.52},
                                          {{150, 150, 150}, 3.86, 6.52, 7.78},
                                          {{200, 200, 200}, 9.56, 17.12, 23.43},
                                          {{250, 250, 250}, 23.26, 39.66, 46.64}}};

double percent_over(double base, double seconds) {
    return 100 * (seconds / base - 1);
}

Json row_of(const Lab& lab, const models::Dims& dims, int rounds) {
    models::Dims size;
    std::transform(dims.begin(), dims.end(), size.begin(),
                   [&](std::uint32_t full) { return lab.stock.size(full); });
    const std::vector<double> seconds = job_seconds(timed_subject(size), kJobs, lab.stock.rounds(rounds));
    Json row{{"dims", size}};
    for (std::size_t i = 0; i < kJobs.size(); ++i) row["seconds"][name_of(kJobs[i])] = seconds[i];
    return row;
}

std::string seconds_text(double seconds) {
    return text(seconds < 0.0995 ? "%.4f" : "%.3f", seconds);
}

std::string with_overhead(double base, double seconds) {
    return seconds_text(seconds) + text(" (%+.0f%%)", percent_over(base, seconds));
}

std::string dims_text(const Json& dims) {
    return text("%u × %u × %u", dims[0].get<unsigned>(), dims[1].get<unsigned>(), dims[2].get<unsigned>());
}

void add_row(bench::Table& table, const Json& row, const PaperRow* paper) {
    const Json& seconds = row["seconds"];
    const double base = seconds[name_of(Job::kDistance)];
    std::vector<std::string> cells{dims_text(row["dims"]), seconds_text(base)};
    for (const Job job : {Job::kCombined, Job::kOctants, Job::kImproved})
        cells.push_back(with_overhead(base, seconds[name_of(job)]));
    if (paper)
        for (const std::string& cell :
             {text("%.2f", paper->distance),
              text("%.2f (%+.0f%%)", paper->combined, percent_over(paper->distance, paper->combined)),
              text("%.2f (%+.0f%%)", paper->octants, percent_over(paper->distance, paper->octants))})
            cells.push_back(cell);
    else
        cells.insert(cells.end(), 3, "–");
    table.row(cells);
}

}  // namespace

Json measure_table2(Lab& lab) {
    Json figures;
    for (const PaperRow& paper : kPaper) figures["rows"].push_back(row_of(lab, paper.dims, 7));
    const Json seconds = figures["rows"].back()["seconds"];
    const double base = seconds[name_of(Job::kDistance)];
    figures["overhead_octants"] = percent_over(base, seconds[name_of(Job::kOctants)]);
    figures["overhead_improved"] = percent_over(base, seconds[name_of(Job::kImproved)]);
    return figures;
}

Json measure_table2_384(Lab& lab) {
    return row_of(lab, {384, 384, 384}, 3);
}

Json measure_table2_512(Lab& lab) {
    return row_of(lab, {512, 512, 512}, 2);
}

void write_table2(const Json& all, bench::Page& page) {
    page.heading(3, "Table 2: seconds of sweeping a volume");
    page.paragraph(
        "The gyroid in bytes, one core, forms taking turns; in brackets what a form adds to the distance "
        "field "
        "alone. \"Combined\" has one value a voxel and no geometry term; \"8 octants\" has the paper's "
        "eight; "
        "\"improved\" is this project's form, with its visibility. The last three columns are the paper's, "
        "on a "
        "Core 2 of 2.66 GHz and volumes of its own.");
    bench::Table table({"voxels", "distance, s", "combined, s", "8 octants, s", "improved, s",
                        "paper: distance, s", "combined, s", "8 octants, s"});
    const Json& rows = all["table2"]["rows"];
    for (std::size_t i = 0; i < rows.size(); ++i) add_row(table, rows[i], &kPaper[i]);
    for (const char* larger : {"table2_384", "table2_512"})
        if (all.contains(larger)) add_row(table, all[larger], nullptr);
    page.table(table);
    const auto range = [&](Job job) {
        double least = 0, most = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Json& seconds = rows[i]["seconds"];
            const double over = percent_over(seconds[name_of(Job::kDistance)], seconds[name_of(job)]);
            least = i ? std::min(least, over) : over, most = i ? std::max(most, over) : over;
        }
        return text("%.0f to %.0f%%", least, most);
    };
    double least = 1e9, most = 0;
    for (const PaperRow& paper : kPaper)
        for (const double seconds : {paper.combined, paper.octants}) {
            least = std::min(least, percent_over(paper.distance, seconds));
            most = std::max(most, percent_over(paper.distance, seconds));
        }
    page.paragraph(
        text("The paper states overheads of 30 to 100%%; its table has %.0f to %.0f%%. Here the "
             "combined form adds %s to these five sizes, eight octants %s, the improved form %s.",
             least, most, range(Job::kCombined).c_str(), range(Job::kOctants).c_str(),
             range(Job::kImproved).c_str()));
}

}  // namespace dfield::volumes
