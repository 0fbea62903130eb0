// Error against samples: five estimators and ray marching, with and without interleaving; the tangent sphere
// as printed and normalised.
#include <array>

#include "baker/picture/plot.hpp"
#include "bench/screen/pieces.hpp"

namespace dfield::screens {
namespace {

using cli::text;

constexpr std::array<std::uint32_t, 5> kSamples{4, 8, 16, 32, 64};

// How an estimator is drawn in plots.
struct Style {
    glm::u8vec3 colour;
    Marker marker;
};
Style style_of(dfield_screen_estimator estimator) {
    switch (estimator) {
        case DFIELD_ESTIMATOR_SPHERE:
            return {{150, 150, 150}, Marker::kCross};
        case DFIELD_ESTIMATOR_HEMISPHERE:
            return {{60, 60, 60}, Marker::kSquare};
        case DFIELD_ESTIMATOR_IMPORTANCE:
            return {{30, 120, 60}, Marker::kTriangle};
        case DFIELD_ESTIMATOR_TANGENT:
            return {{200, 130, 20}, Marker::kDiamond};
        case DFIELD_ESTIMATOR_DISK:
            return {{30, 80, 180}, Marker::kDisc};
        case DFIELD_ESTIMATOR_MARCH:
            return {{190, 40, 40}, Marker::kRing};
    }
    return {};
}

Image plot_of(const Json& rows, const char* key, const char* title, bool interleaved) {
    Plot plot;
    plot.title = title;
    plot.x = {"samples a pixel", true};
    plot.y = {"RMS error, grey levels", true};
    for (const dfield_screen_estimator estimator : cli::kScreenEstimators) {
        const Style style = style_of(estimator);
        PlotSeries series{cli::name_of(estimator), style.colour, style.marker, true, {}};
        for (const Json& row : rows)
            if (row["estimator"] == series.name && row["interleaved"] == interleaved)
                series.points.push_back(
                    {row["samples"].get<double>(), std::max(row[key].get<double>(), 0.05), {}});
        plot.series.push_back(std::move(series));
    }
    return draw_plot(plot);
}

const Json& row_of(const Json& rows, const char* estimator, std::uint32_t samples, bool interleaved) {
    for (const Json& row : rows)
        if (row["estimator"] == estimator && row["samples"] == samples && row["interleaved"] == interleaved)
            return row;
    throw std::logic_error("no such row");
}

}  // namespace

Json measure_errors(const Lab& lab) {
    const cli::ScreenSubject subject = load_screen_subject(lab.input("harbour.glb", "800x600"), lab.common());
    const cli::ScreenRunner runner(subject, 0, lab.references());
    const dfield_screen_desc base = usual_desc(subject.default_radius());
    const RayReference world = runner.by_rays(base, false, false);
    Json rows = Json::array();
    Json limits = Json::object();
    for (const dfield_screen_estimator estimator : cli::kScreenEstimators) {
        dfield_screen_desc desc = base;
        desc.estimator = estimator;
        // Of the same number of lookups as the others: a quarter of the rays, four points each.
        const bool march = estimator == DFIELD_ESTIMATOR_MARCH;
        if (march) desc.march_steps = 4;
        const std::vector<float> integral = runner.integral(desc);
        limits[cli::name_of(estimator)] = cli::rms_grey(integral, world.visibility);
        for (const std::uint32_t samples : kSamples)
            for (const bool interleaved : {false, true}) {
                desc.samples = march ? samples / 4 : samples;
                desc.interleave = interleaved ? 4 : 1;
                desc.filter = interleaved;
                const std::vector<float> at = runner.at_pixels(runner.shade(desc, false, 1).visibility);
                rows.push_back({{"estimator", cli::name_of(estimator)},
                                {"samples", samples},
                                {"interleaved", interleaved},
                                {"to_screen", cli::rms_grey(at, integral)},
                                {"to_world", cli::rms_grey(at, world.visibility)}});
            }
    }
    lab.page.save_picture("screen_errors_apart",
                          plot_of(rows, "to_screen", "one set of samples for all pixels", false));
    lab.page.save_picture("screen_errors",
                          plot_of(rows, "to_screen", "interleaved 4 x 4 and filtered", true));
    const double asked = row_of(rows, "disk", 16, true)["to_screen"];
    return {{"radius", base.radius}, {"asked", asked}, {"rows", rows}, {"limits", limits}};
}

void write_errors(const Json& figures, bench::Page& page) {
    page.heading(3, "Error against samples");
    page.link_picture("screen_errors_apart", "Error against samples, one set of samples for all pixels");
    page.link_picture("screen_errors", "Error against samples, interleaved and filtered");
    page.paragraph(text(
        "The harbour, 800 × 600, R = %.3g, (r/R)^4, against each estimator's own limit by brute force. Ray "
        "marching takes as many lookups as the others, four points a ray, and is held against marching of "
        "4,096 rays with four points each: its plot shows its noise, the table's last column its error.",
        figures["radius"].get<double>()));
    bench::Table table({"16 samples, RMS, grey levels", "one set", "interleaved", "one set, to rays",
                        "interleaved, to rays", "its limit, to rays"});
    for (const dfield_screen_estimator estimator : cli::kScreenEstimators) {
        const char* name = cli::name_of(estimator);
        const Json &apart = row_of(figures["rows"], name, 16, false),
                   &interleaved = row_of(figures["rows"], name, 16, true);
        const auto grey = [](const Json& value) { return text("%.1f", value.get<double>()); };
        table.row({name, grey(apart["to_screen"]), grey(interleaved["to_screen"]), grey(apart["to_world"]),
                   grey(interleaved["to_world"]), grey(figures["limits"][name])});
    }
    page.table(table);
    page.paragraph(
        "What remains to rays is the depth buffer's part: whatever lies behind a surface that is seen counts "
        "as "
        "matter, so that masts, sails and hulls darken what is far behind them within R in the picture. More "
        "samples do not help there; a smaller R does.");
}

Json measure_tangent(const Lab& lab) {
    const cli::ScreenSubject subject = load_screen_subject(lab.input("harbour.glb", "400x300"), lab.common());
    const cli::ScreenRunner runner(subject, 0, lab.references());
    dfield_screen_desc desc = usual_desc(subject.default_radius());
    const std::vector<float> obscurance = runner.integral(desc);
    desc.estimator = DFIELD_ESTIMATOR_TANGENT;
    desc.weights = DFIELD_WEIGHTS_PLAIN;
    Json json;
    for (const bool printed : {false, true}) {
        desc.tangent_as_printed = printed;
        const std::vector<float> integral = runner.integral(desc);
        json[printed ? "printed" : "normalised"] = {
            {"open", *std::max_element(integral.begin(), integral.end())},
            {"rms", cli::rms_grey(integral, obscurance)}};
    }
    return json;
}

void write_tangent(const Json& figures, bench::Page& page) {
    page.heading(3, "The tangent sphere, as printed and normalised");
    bench::Table table({"(r/R)^4", "where all is open", "RMS to the obscurance integral, grey levels"});
    for (const auto& [name, words] : {std::pair{"printed", "as printed in 4.4"},
                                      {"normalised", "divided by its value where all is open"}})
        table.row({words, text("%.3f", figures[name]["open"].get<double>()),
                   text("%.1f", figures[name]["rms"].get<double>())});
    page.table(table);
    page.paragraph(
        "Both by brute force. The formula as printed is another integral than O and does not reach 1; "
        "normalised "
        "it is the default, and what is left is that shrinking the hemisphere to the tangent sphere weighs "
        "distances otherwise. `--tangent-as-printed --weights plain` gives the first.");
}

}  // namespace dfield::screens
