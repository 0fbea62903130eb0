// Visibility of each form against Monte Carlo, at points of the isosurface.
#include <cmath>

#include "baker/cli/form_runner.hpp"
#include "baker/cli/surface_points.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::uint32_t kRays = 512;
constexpr std::size_t kPoints = 4000;

Json accuracy_of(const Lab& lab, const Subject& subject) {
    const cli::VolumeSweeper sweeper(subject.name, subject.volume, subject.isovalue, 0);
    cli::FormRunner runner(sweeper, 1);
    std::vector<float> positions, truth;
    Json figures;
    for (const cli::SweepForm& form : cli::kSweepForms) {
        dfield_sweep_desc desc = sweep_defaults();
        desc.isovalue = subject.isovalue;
        cli::set_form(desc, form);
        runner.sweep(desc);
        if (positions.empty()) {
            positions =
                cli::surface_points(sweeper.grid(), runner.distance(), lab.stock.quick() ? 100 : kPoints);
            truth.resize(positions.size() / 3);
            sweeper.field(runner.distance().data())
                .visibility_by_rays(cli::points_at(positions), lab.stock.quick() ? 32 : kRays, 0,
                                    truth.data());
        }
        const cli::VisibilityError error =
            cli::visibility_error(runner.at(desc, cli::points_at(positions)), truth);
        figures["forms"][form.name] = {
            {"rms", error.rms},
            {"bias", error.bias},
            {"correlation", std::isfinite(error.correlation) ? Json(error.correlation) : Json()}};
    }
    figures["size"] = size_text(subject.volume.grid.size);
    figures["points"] = truth.size();
    figures["improved_over_paper"] =
        figures["forms"]["improved"]["rms"].get<double>() / figures["forms"]["paper"]["rms"].get<double>();
    return figures;
}

std::string cell(const Json& form) {
    const Json& correlation = form["correlation"];  // none where visibility does not vary
    return text("%.3f / %s / %+.3f", form["rms"].get<double>(),
                correlation.is_number() ? text("%.3f", correlation.get<double>()).c_str() : "–",
                form["bias"].get<double>());
}

}  // namespace

Json measure_accuracy(Lab& lab) {
    const std::uint32_t n = lab.stock.size(128);
    const models::Dims dims{n, n, n};
    Json figures;
    for (const Subject& subject : {as_floats("gyroid", models::gyroid_volume(dims, kGyroidPeriods)),
                                   as_floats("floor", models::floor_volume(dims)),
                                   as_floats("vessels", models::vessels_volume(dims, 1)),
                                   as_floats("clouds", models::clouds_volume(dims, 1))})
        figures[subject.name] = accuracy_of(lab, subject);
    return figures;
}

Json measure_accuracy_of_scans(Lab& lab) {
    Json figures = Json::object();
    for (const char* name : Stock::shared_names())
        if (const Subject* subject = lab.stock.shared(name)) figures[name] = accuracy_of(lab, *subject);
    return figures;
}

void write_accuracy(const Json& all, bench::Page& page) {
    page.heading(3, "Against Monte Carlo");
    page.paragraph(
        text("RMS / correlation / bias of visibility, 0 to 1, against %u cosine-weighted rays marched "
             "through the same distance field, at points where the isosurface crosses edges of the "
             "grid, evenly chosen. The paper's form is read from its octants at the point, the others "
             "from their volumes. Improved-48 has twice the ordinates.",
             kRays));
    std::vector<std::string> columns{"volume", "points"};
    for (const cli::SweepForm& form : cli::kSweepForms) columns.push_back(form.name);
    bench::Table table(columns);
    std::string missing;
    for (const char* piece : {"accuracy", "accuracy_of_scans"}) {
        if (!all.contains(piece)) continue;
        for (const auto& [name, figures] : all[piece].items()) {
            std::vector<std::string> cells{name + ", " + figures["size"].get<std::string>(),
                                           bench::grouped(figures["points"].get<std::uint64_t>())};
            for (const cli::SweepForm& form : cli::kSweepForms)
                cells.push_back(cell(figures["forms"][form.name]));
            table.row(cells);
        }
    }
    page.table(table);
    for (const char* name : Stock::shared_names())
        if (!all.contains("accuracy_of_scans") || !all["accuracy_of_scans"].contains(name))
            missing += (missing.empty() ? "" : ", ") + std::string(name);
    if (!missing.empty())
        page.paragraph("**Volumes that were not there, whose rows are left out: " + missing + ".**");
}

}  // namespace dfield::volumes
