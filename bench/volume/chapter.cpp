#include "bench/volume/chapter.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "bench/common/machine.hpp"
#include "bench/volume/pieces.hpp"

namespace dfield::volumes {
namespace {

constexpr Piece kPieces[] = {
    {"distance", measure_distance, write_distance}, {"table2", measure_table2, write_table2},
    {"table2_384", measure_table2_384, nullptr},    {"table2_512", measure_table2_512, nullptr},
    {"bonsai", measure_bonsai, write_bonsai},       {"scale", measure_scale, write_scale},
    {"threads", measure_threads, write_threads},    {"memory", measure_memory, write_memory},
    {"accuracy", measure_accuracy, write_accuracy}, {"accuracy_of_scans", measure_accuracy_of_scans, nullptr},
    {"sphere", measure_sphere, write_sphere},       {"figure3", draw_figure3, write_figure3},
    {"figure4", draw_figure4, write_figure4},       {"figure5", draw_figure5, write_figure5},
    {"figure6", draw_figure6, write_figure6},       {"figure7", draw_figure7, write_figure7},
    {"figure8", draw_figure8, write_figure8},       {"figure9", draw_figure9, write_figure9},
    {"figure10", draw_figure10, write_figure10},
};

void write_asked(const Chapter& chapter, const Json& figures, bench::Page& page) {
    bench::AskedTable table(chapter.name);
    for (const Asked& row : chapter.asked) {
        const Json::json_pointer at(row.figure);
        if (figures.contains(at))
            table.row(row.what, row.bound, figures[at].get<double>());
        else
            table.missing(row.what, row.bound, row.needs);
    }
    page.table(table.table());
}

}  // namespace

const Chapter& sweeping_chapter() {
    static const Chapter kChapter{
        "volumes", "Sweeping volumes",
        "The evaluation of M. Singh, C. Yuksel and D. House, \"Fast Occlusion Sweeping\" (2009), and what "
        "this "
        "project asks of its distance fields and of its occlusion. Times are of one core unless said "
        "otherwise, of whole calls through the C interface from the volume as it was read to packed arrays, "
        "into memory at hand; contestants take turns, and the fastest turn of each counts.",
        kPieces, asked()};
    return kChapter;
}

void measure_pieces(const Chapter& chapter, Lab& lab, std::span<const std::string> wanted, Json& figures) {
    for (const std::string& name : wanted)
        if (std::none_of(chapter.pieces.begin(), chapter.pieces.end(),
                         [&](const Piece& piece) { return name == piece.name; }))
            throw std::invalid_argument("no piece is named " + name);
    for (const Piece& piece : chapter.pieces) {
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), piece.name) == wanted.end()) continue;
        std::fprintf(stderr, "%s: %s\n", chapter.name, piece.name);
        figures[piece.name] = piece.measure(lab);
    }
}

void write_chapter(const Chapter& chapter, const Json& figures, bool quick, bench::Page& page) {
    page.heading(2, chapter.title);
    page.paragraph(std::string(chapter.introduction) + " Measured on " + bench::processor_name() + "; " +
                   bench::compiler_version() + ".");
    if (quick) page.paragraph("**Written with --quick: small volumes, few rays. No figure here counts.**");
    write_asked(chapter, figures, page);
    std::string missing;
    for (const Piece& piece : chapter.pieces)
        if (!figures.contains(piece.name)) missing += (missing.empty() ? "" : ", ") + std::string(piece.name);
    if (!missing.empty())
        page.paragraph("**Parts that were not measured, and are left out: " + missing + ".**");
    for (const Piece& piece : chapter.pieces)
        if (piece.write && figures.contains(piece.name)) piece.write(figures, page);
}

}  // namespace dfield::volumes
