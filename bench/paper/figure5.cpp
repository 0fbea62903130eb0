// Figure 5: even positions with concentric maps against the uniform latitude-longitude sampling.
#include <array>
#include <map>

#include "baker/cli/report.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"
#include "bench/paper/plain_lookup.hpp"
#include "format/file.hpp"

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
        "the paper's uniform picture seems to have them, weighted by their share of the cosine. \"Plain\" is "
        "the paper's lookup, without this project's additions (last table). The last column is against ray "
        "casting with " +
        grouped(lab.directions(Rays::kConverged).directions.size()) +
        " rays and so holds the error of the rays themselves too.");

    const Receivers& receivers = lab.receivers(model, Room::kGap);
    Table table({"field", "rays", "RMS", "max", "RMS, plain", "RMS, many rays"});
    std::vector<Image> rows;
    std::map<std::pair<std::string, Rays>, std::array<double, 2>> rms;  // the runtime's, plain
    for (const Contestant& contestant : contestants) {
        const std::vector<std::byte>& bytes = lab.baked(model, contestant.parameters).bytes;
        const std::vector<float>& reference = lab.ray_cast(model, Room::kGap, contestant.rays);
        Lookup lookup(bytes, receivers, lab.directions(contestant.rays));
        lookup.run();
        const Errors errors = errors_of(lookup.visibility(), reference);
        const Errors plain = errors_of(
            plain_visibility(read_field(bytes), receivers, lab.directions(contestant.rays), {}), reference);
        const Errors converged =
            errors_of(lookup.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConverged));
        rms[{contestant.name, contestant.rays}] = {errors.rms, plain.rms};
        table.row({contestant.name, contestant.ray_name, text("%.2f", errors.rms), text("%.1f", errors.max),
                   text("%.2f", plain.rms), text("%.2f", converged.rms)});
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
    const auto ratio = [&](std::size_t lookup) {
        return rms[{"uniform", Rays::kPolar}][lookup] / rms[{"concentric", Rays::kConcentric}][lookup];
    };
    page.paragraph(
        text("The uniform picture has %.2f times the error of the concentric one, %.2f times with the plain "
             "lookup. ",
             ratio(0), ratio(1)) +
        "Each row of the picture has a reference of its own, cast with its own rays, so that it shows the "
        "field's error alone; the paper seems to hold both against one reference, which adds the difference "
        "between the two sets of rays to its uniform picture. Latitude-longitude points crowd at the poles "
        "and are twice as far apart along the equator as across it; cells of a polar map are slivers near "
        "the "
        "normal and four times as wide as high at the horizon.");
}

}  // namespace dfield::paper
