// One function a figure of the paper: measures, and writes its part of the page.
#pragma once

#include "bench/common/page.hpp"
#include "bench/paper/lab.hpp"
#include "bench/paper/measure.hpp"

namespace dfield::paper {

using bench::grouped, bench::Page, bench::square, bench::Table;

// A model and the same surface cut into many more triangles (midpoint subdivision), looked up in turns.
struct Million {
    const Model* model = nullptr;
    std::size_t triangles = 0;  // after subdivision
    double original_bake_seconds = 0, bake_seconds = 0;
    double original_lookup_seconds = 0, lookup_seconds = 0;
    double rms = 0;  // of the subdivided one, against ray casting of the original
    Duel duel;       // of the subdivided one

    double lookup_ratio() const { return lookup_seconds / original_lookup_seconds; }
};
Million measure_million(Lab& lab);

void write_limits(Lab& lab, const Million& million, Page& page);
void write_figure2(Lab& lab, Page& page);
void write_figure4(Lab& lab, Page& page);
void write_figure5(Lab& lab, Page& page);
void write_figure6(Lab& lab, Page& page);
void write_figure7(Lab& lab, Page& page);
void write_figure8(Lab& lab, const Million& million, Page& page);
void write_several_objects(Lab& lab, Page& page);
void write_ablation(Lab& lab, Page& page);

// "4,226 maps of 32 × 32", counted as the paper does.
std::string maps_text(const FieldParameters& parameters);

}  // namespace dfield::paper
