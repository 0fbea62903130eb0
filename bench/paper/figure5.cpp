// Figure 5: even positions with concentric maps against the uniform latitude-longitude sampling.
#include <array>

#include "baker/cli/report.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

using cli::text;

struct Contestant {
    const char* name;
    FieldParameters parameters;
    Rays rays;
    const char* ray_name;
};

}  // namespace

void write_figure5(Lab& lab, Page& page) {
    const Model& model = lab.subject();
    FieldParameters even = lab.parameters(16, 64), uniform = even;
    uniform.positions = Positions::kLatlong;
    uniform.mapping = Mapping::kPolar;
    const std::array<Contestant, 4> contestants{{{"concentric", even, Rays::kConcentric, "concentric"},
                                                 {"uniform", uniform, Rays::kConcentric, "concentric"},
                                                 {"uniform", uniform, Rays::kPolar, "polar, weighted"},
                                                 {"concentric", even, Rays::kPolar, "polar, weighted"}}};

    page.heading(2, "Figure 5: concentric against uniform sampling");
    page.paragraph(
        "The " + model.name + ". \"Concentric\": " + maps_text(even) + " at Slater's points. \"Uniform\": " +
        maps_text(uniform) + ", latitude-longitude points with polar maps. " +
        std::to_string(lab.directions(Rays::kConcentric).directions.size()) +
        " rays a vertex: cosine-weighted ones from the concentric map, or even in both angles (polar), as "
        "the paper's uniform picture seems to have them, weighted by their share of the cosine. The last "
        "column is against ray casting with " +
        grouped(lab.directions(Rays::kConverged).directions.size()) +
        " rays and so holds the error of the rays themselves too.");

    Table table({"field", "rays", "RMS, same rays", "max", "RMS, many rays"});
    std::vector<Image> rows;
    for (const Contestant& contestant : contestants) {
        Lookup lookup(lab.baked(model, contestant.parameters).bytes, lab.receivers(model, Room::kGap),
                      lab.directions(contestant.rays));
        lookup.run();
        const Errors errors =
            errors_of(lookup.visibility(), lab.ray_cast(model, Room::kGap, contestant.rays));
        const Errors converged =
            errors_of(lookup.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConverged));
        table.row({contestant.name, contestant.ray_name, text("%.2f", errors.rms), text("%.1f", errors.max),
                   text("%.2f", converged.rms)});
        if ((contestant.rays == Rays::kPolar) != (contestant.parameters == uniform)) continue;
        const auto images =
            corner_images(lab, model, Room::kGap, contestant.rays, lookup.visibility(), 400, 340);
        const std::array<std::string, 3> captions{std::string("ray casting"),
                                                  std::string(contestant.name) + " sampling",
                                                  text("difference x5, RMS %.2f", errors.rms)};
        rows.push_back(image_row(images, captions));
    }
    page.table(table);
    page.picture("figure5", image_column(rows),
                 "Reference, lookup and their difference times five: concentric above, uniform below");
    page.paragraph(
        "Each row of the picture has its own reference, cast with its own rays. The order is the paper's. "
        "Latitude-longitude points crowd at the poles and leave the equator thin; polar maps spend half of "
        "their texels on directions within 45 degrees of the normal in rings that shrink to a point, and few "
        "on the grazing ones that a neighbour's rays need.");
}

}  // namespace dfield::paper
