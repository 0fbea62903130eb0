// Milliseconds a frame, and SIMD over scalar.
#include <limits>

#include "bench/screen/pieces.hpp"

namespace dfield::screens {
namespace {

using cli::text;

struct Frame {
    cli::ScreenSubject subject;
    cli::ScreenRunner fast, scalar;

    explicit Frame(const Lab& lab)
        : subject(load_screen_subject(lab.input("harbour.glb", "800x600"), lab.common())),
          fast(subject, 1, {1, 1}),
          scalar(subject, 1, {1, 1}, DFIELD_SIMD_SCALAR) {}
};

}  // namespace

Json measure_speed(const Lab& lab) {
    const Frame frame(lab);
    const dfield_screen_desc base = usual_desc(frame.subject.default_radius());
    Json rows = Json::array();
    double asked = 0, ratio = 0, least = std::numeric_limits<double>::infinity();
    const auto add = [&](const dfield_screen_desc& desc, const std::string& name) {
        Json row{{"estimator", name}};
        for (const bool indirect : {false, true}) {
            const double fast = frame.fast.shade(desc, indirect, lab.rounds()).ms;
            const double scalar = frame.scalar.shade(desc, indirect, lab.quick ? 1 : 3).ms;
            row[indirect ? "indirect" : "visibility"] = {{"ms", fast}, {"scalar_ms", scalar}};
            least = std::min(least, scalar / fast);
            const bool usual = desc.estimator == base.estimator && desc.measure == base.measure;
            if (usual && indirect) asked = fast, ratio = scalar / fast;
        }
        rows.push_back(std::move(row));
    };
    for (const dfield_screen_estimator estimator : cli::kScreenEstimators) {
        dfield_screen_desc desc = base;
        desc.estimator = estimator;
        if (estimator == DFIELD_ESTIMATOR_MARCH) desc.samples = 4, desc.march_steps = 4;
        add(desc, cli::name_of(estimator));
    }
    for (const auto& [measure, name] : {std::pair{DFIELD_MEASURE_QUADRATIC, "quadratic"},
                                        {DFIELD_MEASURE_LINEAR, "linear"},
                                        {DFIELD_MEASURE_EXPONENTIAL, "exponential"}}) {
        dfield_screen_desc desc = base;
        desc.measure = measure;
        desc.sigma = 1 / desc.radius;
        add(desc, std::string("disk, ") + name);
    }
    return {{"asked_ms", asked}, {"simd_over_scalar", ratio}, {"least_over_scalar", least}, {"rows", rows}};
}

void write_speed(const Json& figures, bench::Page& page) {
    page.heading(3, "Speed");
    bench::Table table({"800 × 600, 16 samples, ms", "visibility", "scalar", "ratio", "with indirect light",
                        "scalar", "ratio"});
    for (const Json& row : figures["rows"]) {
        std::vector<std::string> cells{row["estimator"].get<std::string>()};
        for (const char* what : {"visibility", "indirect"}) {
            const double ms = row[what]["ms"].get<double>(), scalar = row[what]["scalar_ms"].get<double>();
            cells.insert(cells.end(), {text("%.1f", ms), text("%.0f", scalar), text("%.1f", scalar / ms)});
        }
        table.row(std::move(cells));
    }
    page.table(table);
    page.paragraph(
        "Interleaved 4 × 4 and filtered, the harbour of the pictures; the quartic measure unless another is "
        "named. March: four rays of four points. Scalar: what contexts capped at DFIELD_SIMD_SCALAR run, the "
        "reference of the tests. The paper reports over 100 frames a second, 10 ms, on its graphics "
        "processor.");
}

}  // namespace dfield::screens
