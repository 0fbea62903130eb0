// Figure 6: resolutions of positions and directions.
#include <array>

#include "baker/cli/report.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"
#include "bench/paper/plain_lookup.hpp"
#include "format/file.hpp"

namespace dfield::paper {
namespace {

using cli::text;

constexpr std::array<std::uint32_t, 4> kMapSizes{8, 16, 32, 64}, kSubdivisions{8, 16, 32, 64};

struct Cell {
    FieldParameters parameters;
    double bake_seconds, lookup_seconds, rms, plain_rms;
    std::size_t file_bytes;
    Image difference;
};
using Row = std::array<Cell, kMapSizes.size()>;

Cell measure(Lab& lab, const Model& model, const FieldParameters& parameters) {
    const Baked& field = lab.baked(model, parameters);
    const Receivers& receivers = lab.receivers(model, Room::kGap);
    const Directions& rays = lab.directions(Rays::kConcentric);
    const std::vector<float>& reference = lab.ray_cast(model, Room::kGap, Rays::kConcentric);
    Lookup lookup(field.bytes, receivers, rays);
    Cell cell;
    cell.parameters = parameters;
    cell.bake_seconds = field.seconds();
    cell.lookup_seconds = lookup.fastest_run(lab.rounds(7));
    cell.rms = errors_of(lookup.visibility(), reference).rms;
    cell.plain_rms = errors_of(plain_visibility(read_field(field.bytes), receivers, rays, {}), reference).rms;
    cell.file_bytes = field.bytes.size();
    cell.difference =
        corner_images(lab, model, Room::kGap, Rays::kConcentric, lookup.visibility(), 220, 187)[2];
    return cell;
}

// One row for each number of positions, one column for each size of map.
template<class Text>
Table table_of(const std::vector<Row>& rows, const char* title, const Text& text_of) {
    std::vector<std::string> columns{title};
    for (const Cell& cell : rows.front()) columns.push_back(square(cell.parameters.map_size));
    Table table(columns);
    for (const Row& row : rows) {
        const FieldParameters& parameters = row.front().parameters;
        std::vector<std::string> cells{grouped(paper_position_count(parameters)) + " (" +
                                       grouped(position_count(parameters)) + ")"};
        for (const Cell& cell : row) cells.push_back(text_of(cell));
        table.row(cells);
    }
    return table;
}

Image picture_of(const std::vector<Row>& rows) {
    std::vector<Image> pictures;
    for (std::size_t i = 0; i < 3; ++i) {  // the paper's three
        std::vector<Image> images;
        std::vector<std::string> captions;
        for (const Cell& cell : rows[i]) {
            images.push_back(cell.difference);
            captions.push_back(text("%s / %ux%u: %.2f",
                                    grouped(paper_position_count(cell.parameters)).c_str(),
                                    cell.parameters.map_size, cell.parameters.map_size, cell.rms));
        }
        pictures.push_back(image_row(images, captions));
    }
    return image_column(pictures);
}

}  // namespace

void write_figure6(Lab& lab, Page& page) {
    const Model& model = lab.subject();
    std::vector<Row> rows(kSubdivisions.size());
    for (std::size_t i = 0; i < kSubdivisions.size(); ++i)
        for (std::size_t j = 0; j < kMapSizes.size(); ++j)
            rows[i][j] = measure(lab, model, lab.parameters(kSubdivisions[i], kMapSizes[j]));

    page.heading(2, "Figure 6: resolutions");
    page.paragraph(
        "The " + model.name +
        ", 8 bits, concentric maps of the size above each column. Rows are positional samples as the paper "
        "counts them (its three numbers, and one more) and, in brackets, as they are stored: points on the "
        "equator once.");
    page.table(table_of(rows, "bake, s / AO, ms / RMS", [](const Cell& cell) {
        return text("%.2f / %.1f / %.2f", cell.bake_seconds, 1e3 * cell.lookup_seconds, cell.rms);
    }));
    page.table(table_of(rows, "RMS of the paper's lookup",
                        [](const Cell& cell) { return text("%.2f", cell.plain_rms); }));
    page.table(table_of(rows, "file, KiB", [](const Cell& cell) {
        return text("%.0f", static_cast<double>(cell.file_bytes) / 1024);
    }));
    page.paragraph("The pictures look alike, so here are their differences from ray casting, times five:");
    page.picture("figure6", picture_of(rows),
                 "Differences from ray casting: directions from left to right, positions from top to bottom");
    const auto gain = [](const Cell& from, const Cell& to, double Cell::*rms) { return from.*rms / to.*rms; };
    page.paragraph(
        text("From the first to the third row the error falls by a factor of %.2f in the third column, with "
             "the "
             "paper's lookup by %.2f: the pivot (last table) removes part of the error that more positions "
             "used "
             "to. ",
             gain(rows[0][2], rows[2][2], &Cell::rms), gain(rows[0][2], rows[2][2], &Cell::plain_rms)) +
        text("The paper finds that directions hardly matter. In the third row its lookup gains %.2f from the "
             "first column to the second, %.2f from the third to the fourth (%.2f and %.2f with the pivot): "
             "that "
             "holds for fine maps only. ",
             gain(rows[2][0], rows[2][1], &Cell::plain_rms), gain(rows[2][2], rows[2][3], &Cell::plain_rms),
             gain(rows[2][0], rows[2][1], &Cell::rms), gain(rows[2][2], rows[2][3], &Cell::rms)) +
        "As in the paper a lookup's time does not depend on the resolution, until a field outgrows the "
        "caches.");
}

}  // namespace dfield::paper
