// The pieces of the chapter "Cutting volumes".
#pragma once

#include "bench/volume/chapter.hpp"

namespace dfield::cutting {

using cli::Json;
using volumes::Lab;

Json measure_haze(Lab& lab);
Json measure_engine(Lab& lab);
Json measure_beetle(Lab& lab);
Json measure_skeleton(Lab& lab);
Json measure_moving(Lab& lab);
Json measure_approximate(Lab& lab);
Json measure_accuracy(Lab& lab);
Json measure_jitter(Lab& lab);
Json draw_figure1(Lab& lab);
Json draw_figure8(Lab& lab);
Json draw_figure9(Lab& lab);
Json draw_figure11(Lab& lab);
Json draw_surfaces(Lab& lab);

void write_haze(const Json& figures, bench::Page& page);
void write_scenes(const Json& figures, bench::Page& page);
void write_moving(const Json& figures, bench::Page& page);
void write_approximate(const Json& figures, bench::Page& page);
void write_accuracy(const Json& figures, bench::Page& page);
void write_jitter(const Json& figures, bench::Page& page);
void write_figure1(const Json& figures, bench::Page& page);
void write_figure8(const Json& figures, bench::Page& page);
void write_figure9(const Json& figures, bench::Page& page);
void write_figure11(const Json& figures, bench::Page& page);
void write_surfaces(const Json& figures, bench::Page& page);

}  // namespace dfield::cutting
