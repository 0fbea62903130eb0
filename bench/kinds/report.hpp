// What the measurements of the kinds found, and its forms: a page's chapter with plots, and JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/cli/report.hpp"
#include "bench/common/page.hpp"
#include "bench/kinds/asked.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::kinds {

// The level of instructions and the seconds at it.
struct LevelSeconds {
    std::string level;
    double seconds;
};

// One size of one kind, or a peer, in one model's corner.
struct Row {
    std::string model, kind, size;
    bool headline = true;  // in the tables; the others are in plots and JSON only
    bool peer = false;
    bool shared = false;  // directions shared by all receivers, otherwise around each normal
    std::uint64_t memory_bytes = 0, file_bytes = 0;  // no file: 0
    double rms = 0, max = 0;                         // against Embree with the same rays
    std::size_t receivers = 0, rays = 0;
    double seconds = 0;                // with the best instructions
    std::vector<LevelSeconds> levels;  // all that were measured; empty for peers
    double embree_seconds = 0;         // with the same rays
    std::string embree_mode;

    double ns_per_ray() const { return seconds * 1e9 / static_cast<double>(rays); }
    double ns_per_receiver() const { return seconds * 1e9 / static_cast<double>(receivers); }
    double speedup() const { return embree_seconds / seconds; }
};

// A layout of many instances, whole frames from scratch and one instance moved.
struct InstancesRow {
    std::string layout, maps;
    std::size_t instances = 0, receivers = 0, rays = 0;
    double frame_seconds = 0;  // transforms set, hierarchy refitted, all receivers looked up
    double embree_seconds = 0;
    std::string embree_mode;
    double rms = 0;
    double moved_seconds =
        0;  // one instance: transform set, hierarchy refitted, receivers updated; the median
    double moved_receivers = 0;  // looked at again, the mean
    double two_threads_seconds = 0, one_thread_seconds = 0;

    double speedup() const { return embree_seconds / frame_seconds; }
};

// The error of one kind on a transformed instance, in the corner around it.
struct ScaleRow {
    std::string kind;
    double plain = 0, non_uniform = 0, mirrored = 0;
};

struct Report {
    std::vector<Row> rows;
    std::vector<InstancesRow> instances;
    std::vector<ScaleRow> scales;
    Measured measured;
};

// Measures everything on one core. Some minutes; what it is at goes to stderr.
Report measure_kinds(paper::Lab& lab);

// Its parts; each adds to the report.
void say_progress(const std::string& what);
void measure_corners(paper::Lab& lab, Report& report);
void measure_instances(paper::Lab& lab, Report& report);
void measure_scales(paper::Lab& lab, Report& report);

void write_kinds(const Report& report, bench::Page& page);
cli::Json kinds_json(const Report& report);

}  // namespace dfield::kinds
