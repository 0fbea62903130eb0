#include "bench/screen/chapter.hpp"

#include <cstdio>

#include "bench/common/asked.hpp"
#include "bench/common/machine.hpp"

namespace dfield::screens {
namespace {

constexpr Piece kPieces[] = {
    {"errors", measure_errors, write_errors}, {"tangent", measure_tangent, write_tangent},
    {"speed", measure_speed, write_speed},    {"figure1", draw_figure1, write_figure1},
    {"figure7", draw_figure7, write_figure7}, {"figure8", draw_figure8, write_figure8},
    {"figure9", draw_figure9, write_figure9}, {"far", measure_far, write_far},
};

struct Asked {
    const char* figure;  // JSON pointer into all figures
    const char* what;
    bench::Bound bound;
};
constexpr Asked kAsked[] = {
    {"/errors/asked",
     "16 samples, interleaved and filtered, base disk: RMS to the converged integral, grey levels",
     {false, 6, 3, "%.1f"}},
    {"/speed/asked_ms", "800 × 600, 16 samples, with indirect light, one core", {false, 60, 10, "%.1f ms"}},
    {"/speed/simd_over_scalar", "the same: SIMD over scalar", {true, 6, 12, "%.1f ×"}},
    {"/speed/least_over_scalar",
     "SIMD over scalar, the least of all estimators and measures, with and without indirect light",
     {true, 6, 12, "%.1f ×"}},
};

void write_asked(const Json& figures, bench::Page& page) {
    bench::AskedTable table("screen space");
    for (const Asked& row : kAsked)
        table.row(row.what, row.bound, figures.at(Json::json_pointer(row.figure)).get<double>());
    page.table(table.table());
}

}  // namespace

cli::CommonOptions Lab::common() const {
    cli::CommonOptions common;
    common.threads = 1;
    common.quiet = true;
    return common;
}

cli::ReferenceOptions Lab::references() const {
    return quick ? cli::ReferenceOptions{100, 64} : cli::ReferenceOptions{2048, 1024};
}

cli::ScreenInput Lab::input(const std::string& file, const std::string& size) const {
    cli::ScreenInput input;
    input.file = (models / file).string();
    input.size = quick ? "80x60" : size;
    return input;
}

dfield_screen_desc usual_desc(float radius) {
    dfield_screen_desc desc;
    dfield_screen_desc_init(&desc);
    desc.radius = radius;
    desc.samples = 16;
    return desc;
}

void write_screen(const Lab& lab, bench::Page& page) {
    Json figures;
    for (const Piece& piece : kPieces) {
        std::fprintf(stderr, "screen: %s\n", piece.name);
        figures[piece.name] = piece.measure(lab);
    }
    page.heading(2, "Screen space");
    page.paragraph(
        "The results of L. Szirmay-Kalos, B. Tóth, T. Umenhoffer and M. Sbert, \"GPU-based Ambient Occlusion "
        "and "
        "Indirect Illumination\", and what this project asks of its screen-space occlusion. Scenes are the "
        "project's own; the harbour stands in for the paper's. Visibility is compared in grey levels, 0 to "
        "255, "
        "over pixels that show a surface: with the integral that the estimator converges to in the same "
        "buffers "
        "(its own error), and with the same integral by rays through the whole scene (what a depth buffer "
        "does "
        "not know as well). Times are of one core, from buffers to result, the fastest of several frames. "
        "Measured on " +
        bench::processor_name() + "; " + bench::compiler_version() + ".");
    if (lab.quick)
        page.paragraph("**Written with --quick: small pictures, few rays. No figure here counts.**");
    write_asked(figures, page);
    for (const Piece& piece : kPieces) piece.write(figures[piece.name], page);
}

}  // namespace dfield::screens
