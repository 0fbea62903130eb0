// The pieces of the chapter "Sweeping volumes".
#pragma once

#include "bench/volume/chapter.hpp"

namespace dfield::volumes {

Json measure_distance(Lab& lab);
Json measure_table2(Lab& lab);
Json measure_table2_384(Lab& lab);
Json measure_table2_512(Lab& lab);
Json measure_bonsai(Lab& lab);
Json measure_scale(Lab& lab);
Json measure_threads(Lab& lab);
Json measure_memory(Lab& lab);
Json measure_accuracy(Lab& lab);
Json measure_accuracy_of_scans(Lab& lab);
Json measure_sphere(Lab& lab);
Json draw_figure3(Lab& lab);
Json draw_figure4(Lab& lab);
Json draw_figure5(Lab& lab);
Json draw_figure6(Lab& lab);
Json draw_figure7(Lab& lab);
Json draw_figure8(Lab& lab);
Json draw_figure9(Lab& lab);
Json draw_figure10(Lab& lab);

void write_distance(const Json& figures, bench::Page& page);
void write_table2(const Json& figures, bench::Page& page);
void write_bonsai(const Json& figures, bench::Page& page);
void write_scale(const Json& figures, bench::Page& page);
void write_threads(const Json& figures, bench::Page& page);
void write_memory(const Json& figures, bench::Page& page);
void write_accuracy(const Json& figures, bench::Page& page);
void write_sphere(const Json& figures, bench::Page& page);
void write_figure3(const Json& figures, bench::Page& page);
void write_figure4(const Json& figures, bench::Page& page);
void write_figure5(const Json& figures, bench::Page& page);
void write_figure6(const Json& figures, bench::Page& page);
void write_figure7(const Json& figures, bench::Page& page);
void write_figure8(const Json& figures, bench::Page& page);
void write_figure9(const Json& figures, bench::Page& page);
void write_figure10(const Json& figures, bench::Page& page);

}  // namespace dfield::volumes
