#include "bench/cutting/chapter.hpp"

#include "bench/cutting/asked.hpp"
#include "bench/cutting/pieces.hpp"

namespace dfield::cutting {
namespace {

constexpr volumes::Piece kPieces[] = {
    {"surfaces", draw_surfaces, write_surfaces},
    {"haze", measure_haze, write_haze},
    {"engine", measure_engine, write_scenes},
    {"beetle", measure_beetle, nullptr},
    {"skeleton", measure_skeleton, nullptr},
    {"moving", measure_moving, write_moving},
    {"approximate", measure_approximate, write_approximate},
    {"accuracy", measure_accuracy, write_accuracy},
    {"jitter", measure_jitter, write_jitter},
    {"figure1", draw_figure1, write_figure1},
    {"figure8", draw_figure8, write_figure8},
    {"figure9", draw_figure9, write_figure9},
    {"figure11", draw_figure11, write_figure11},
};

}  // namespace

const volumes::Chapter& cutting_chapter() {
    static const volumes::Chapter kChapter{
        "cutting", "Cutting volumes",
        "The evaluation of A. Titov, M. Kersten-Oertel and S. Drouin, \"Contextual Ambient Occlusion\" "
        "(2024): "
        "local ambient occlusion (LAO) and contextual (CAO), which is the same while meshes cut the volume; "
        "and what this project asks of them. Times are of one core unless said otherwise, of whole calls "
        "through the C interface; the fastest of a few turns counts. Transfer functions are in "
        "[models/transfer_functions](../models/transfer_functions). Pictures show twice the factors, at most "
        "1, so "
        "that planes that nothing hides are not dark.",
        kPieces, asked()};
    return kChapter;
}

}  // namespace dfield::cutting
