// Milliseconds a frame, and SIMD over scalar.
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
    double asked = 0, ratio = 0;
    for (const dfield_screen_estimator estimator : cli::kScreenEstimators) {
        dfield_screen_desc desc = base;
        desc.estimator = estimator;
        if (estimator == DFIELD_ESTIMATOR_MARCH) desc.samples = 4, desc.march_steps = 4;
        Json row{{"estimator", cli::name_of(estimator)}};
        for (const bool indirect : {false, true}) {
            const double fast = frame.fast.shade(desc, indirect, lab.rounds()).ms;
            const double scalar = frame.scalar.shade(desc, indirect, lab.quick ? 1 : 3).ms;
            row[indirect ? "indirect" : "visibility"] = {{"ms", fast}, {"scalar_ms", scalar}};
            if (estimator == DFIELD_ESTIMATOR_DISK && indirect) asked = fast, ratio = scalar / fast;
        }
        rows.push_back(std::move(row));
    }
    return {{"asked_ms", asked}, {"simd_over_scalar", ratio}, {"rows", rows}};
}

void write_speed(const Json& figures, bench::Page& page) {
    page.heading(3, "Speed");
    bench::Table table(
        {"800 × 600, 16 samples, ms", "visibility", "scalar", "with indirect light", "scalar"});
    for (const Json& row : figures["rows"]) {
        const auto ms = [&](const char* what, const char* key) {
            return text("%.1f", row[what][key].get<double>());
        };
        table.row({row["estimator"].get<std::string>(), ms("visibility", "ms"), ms("visibility", "scalar_ms"),
                   ms("indirect", "ms"), ms("indirect", "scalar_ms")});
    }
    page.table(table);
    page.paragraph(
        "Interleaved 4 × 4 and filtered, the harbour of the pictures. March: four rays of four points. The "
        "paper "
        "reports over 100 frames a second, 10 ms, on its graphics processor.");
}

}  // namespace dfield::screens
