// The page's chapter about the kinds, and the same figures as JSON.
#include <algorithm>
#include <array>
#include <cstdio>

#include "baker/picture/image.hpp"
#include "baker/picture/plot.hpp"
#include "bench/kinds/contest.hpp"
#include "bench/kinds/report.hpp"

namespace dfield::kinds {
namespace {

using cli::text;

std::string kilobytes(std::uint64_t bytes) {
    return text(bytes < 100000 ? "%.1f" : "%.0f", 1e-3 * static_cast<double>(bytes));
}

void write_asked(const Report& report, bench::Page& page) {
    bench::AskedTable table("figure");
    for (const Asked& row : asked())
        if (const auto at = report.measured.find(row.figure); at != report.measured.end())
            table.row(row.what, row.bound, at->second);
    if (!report.measured.empty()) page.table(table.table());
}

std::string level_text(const Row& row, const char* name) {
    for (const LevelSeconds& level : row.levels)
        if (level.level == name) return text("%.1f", row.embree_seconds / level.seconds);
    return "–";
}

std::vector<std::string> models_of(const Report& report) {
    std::vector<std::string> models;
    for (const Row& row : report.rows)
        if (models.empty() || models.back() != row.model) models.push_back(row.model);
    return models;
}

void write_corners(const Report& report, bench::Page& page) {
    page.heading(3, "One instance in the corner");
    page.paragraph(
        "Errors are RMS in grey levels, against Embree with the same rays: 256 cosine-weighted ones around "
        "each "
        "normal, or for direction maps the " +
        std::to_string(kSharedDirections) +
        " directions that all receivers share, those above the receiver's plane. Times are of the whole call "
        "on "
        "one core, set-up included, per ray and per receiver; × are against Embree on the same rays in the "
        "fastest of seven modes, by the instructions that the lookup was held to. Embree and the distance "
        "fields, "
        "which take long, are timed in parts of a millisecond or so, each part by its fastest turn; lookups "
        "are "
        "repeated for as long, and the fastest call counts, so that both sides find what they read in the "
        "caches. "
        "Memory is in "
        "thousands of bytes. Peers: a signed distance field as game engines ship it (8 bits a node, sphere "
        "traced, a vector of rays at a time; the best of with and without a sign, as sheets and leaves have "
        "no "
        "inside), and Malmer et al.'s grid of spherical caps, one read a receiver whatever the rays.");
    for (const std::string& model : models_of(report)) {
        const auto first = std::find_if(report.rows.begin(), report.rows.end(),
                                        [&](const Row& row) { return row.model == model; });
        bench::Table table({model, "RMS", "max", "memory", "file", "ns a ray", "ns a receiver", "SSE4, ×",
                            "AVX2, ×", "AVX-512, ×", "×"});
        for (const Row& row : report.rows) {
            if (row.model != model || !row.headline) continue;
            table.row({row.kind + ", " + row.size, text("%.2f", row.rms), text("%.0f", row.max),
                       kilobytes(row.memory_bytes), row.file_bytes ? kilobytes(row.file_bytes) : "–",
                       text("%.3f", row.ns_per_ray()), text("%.0f", row.ns_per_receiver()),
                       level_text(row, "SSE4"), level_text(row, "AVX2"), level_text(row, "AVX-512"),
                       text("%.1f", row.speedup())});
        }
        const double embree = first->embree_seconds * 1e9;
        table.row({"Embree, " + first->embree_mode, "0", "0", "–", "–",
                   text("%.1f", embree / static_cast<double>(first->rays)),
                   text("%.0f", embree / static_cast<double>(first->receivers)), "–", "–", "–", "1"});
        page.table(table);
    }
}

struct Look {
    const char *kind, *size_ends, *name;
    glm::u8vec3 colour;
    Marker marker;
};
// Letters of the font are ASCII.
constexpr Look kLooks[] = {
    {"displacement maps, 8 bit", "", "maps, 8 bit", {31, 119, 180}, Marker::kDisc},
    {"displacement maps, 1 bit", "", "maps, 1 bit", {23, 190, 207}, Marker::kRing},
    {"line table", "", "line table", {44, 160, 44}, Marker::kSquare},
    {"line table, pivot, ellipsoid", "", "lines, pivot", {120, 180, 40}, Marker::kDiamond},
    {"direction maps", "× 32²", "directions, 32^2", {214, 39, 40}, Marker::kDisc},
    {"direction maps", "× 64²", "directions, 64^2", {255, 127, 14}, Marker::kDisc},
    {"occlusion volume", "", "occlusion volume", {23, 190, 207}, Marker::kDisc},
    {"distance field", "", "distance field", {120, 120, 120}, Marker::kTriangle},
    {"grid of caps", "", "grid of caps", {148, 103, 189}, Marker::kCross},
};

std::string bytes_label(double value) {
    return value < 1e6 ? text("%g KB", value * 1e-3) : text("%g MB", value * 1e-6);
}
std::string nanoseconds_label(double value) {
    return text("%g ns", value);
}
std::string grey_label(double value) {
    return text("%g", value);
}

std::string ascii(std::string size) {
    for (const auto& [from, to] : {std::pair{"×", "x"}, {"²", "^2"}, {"³", "^3"}})
        for (std::size_t at; (at = size.find(from)) != std::string::npos;)
            size.replace(at, std::string(from).size(), to);
    size.erase(std::remove(size.begin(), size.end(), ' '), size.end());
    return size;
}

Image plot_of(const Report& report, const std::string& model, bool time) {
    Plot plot;
    plot.title = model + (time ? ": error against time" : ": error against memory");
    plot.x = {time ? "nanoseconds a ray, one core" : "bytes in memory", true, 0, 0,
              time ? nanoseconds_label : bytes_label};
    plot.y = {"RMS, grey levels of 255", true, 0, 0, grey_label};
    for (const Look& look : kLooks) {
        PlotSeries series{look.name, look.colour, look.marker, !time, {}};
        for (const Row& row : report.rows)
            if (row.model == model && row.kind == look.kind && row.size.ends_with(look.size_ends))
                series.points.push_back({time ? row.ns_per_ray() : static_cast<double>(row.memory_bytes),
                                         row.rms, ascii(row.size)});
        std::sort(series.points.begin(), series.points.end(),
                  [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    // Ray casting has no error of its own: its time is a line.
    for (const Row& row : report.rows) {
        if (!time || row.model != model || row.peer || row.shared) continue;
        double least = row.rms, most = row.rms;
        for (const PlotSeries& series : plot.series)
            for (const PlotPoint& point : series.points)
                least = std::min(least, point.y), most = std::max(most, point.y);
        const double embree = row.embree_seconds * 1e9 / static_cast<double>(row.rays);
        plot.series.push_back(
            {"Embree (exact)", {0, 0, 0}, Marker::kDiamond, true, {{embree, least, ""}, {embree, most, ""}}});
        break;
    }
    return draw_plot(plot);
}

void write_plots(const Report& report, bench::Page& page) {
    page.heading(3, "Error against memory and against time");
    page.paragraph(
        "Each kind in several sizes, beside the peers. A line joins the sizes of one kind. Further to the "
        "left and "
        "further down is better.");
    for (const std::string& model : models_of(report)) {
        if (std::none_of(report.rows.begin(), report.rows.end(),
                         [&](const Row& row) { return row.model == model && !row.headline; }))
            continue;
        std::string name = "kinds_" + model;
        std::replace(name.begin(), name.end(), ' ', '_');
        const std::array<Image, 2> plots{plot_of(report, model, false), plot_of(report, model, true)};
        page.picture(name, image_column(plots, 24), model + ": error against memory, and against time");
    }
}

void write_instances(const Report& report, bench::Page& page) {
    page.heading(3, "Many instances");
    page.paragraph("Objects over a ground that receives, by direction maps, " +
                   std::to_string(kSharedDirections) +
                   " shared directions. A frame: all transforms set, the hierarchy refitted, all receivers "
                   "looked up from scratch, "
                   "one core. Embree has the objects as instances and traces the same rays in the fastest of "
                   "its four incoherent "
                   "modes (its coherent packets do not return from such scenes), its own set-up not counted. "
                   "\"One moved\": one "
                   "instance moves by a frame's step, and the receivers that it can affect are computed "
                   "again; the result is "
                   "compared with a whole query's, bit by bit.");
    bench::Table table({"layout", "maps", "receivers", "rays", "frame, ms", "Embree, s", "×", "RMS",
                        "one moved, ms", "of the frame", "receivers looked at", "two threads, ×"});
    for (const InstancesRow& row : report.instances)
        table.row({row.layout, row.maps, bench::grouped(row.receivers), bench::grouped(row.rays),
                   text("%.2f", row.frame_seconds * 1e3), text("%.3f", row.embree_seconds),
                   text("%.0f", row.speedup()), text("%.2f", row.rms), text("%.3f", row.moved_seconds * 1e3),
                   text("%.2f%%", 100 * row.moved_seconds / row.frame_seconds),
                   text("%.0f", row.moved_receivers),
                   text("%.2f", row.one_thread_seconds / row.two_threads_seconds)});
    page.table(table);
}

void write_scales(const Report& report, bench::Page& page) {
    page.heading(3, "Non-uniform and mirrored scale");
    page.paragraph(
        "RMS of a rotated instance in the corner around it; scaled by 1, 1.6 and 0.6 along its axes; "
        "mirrored. In "
        "brackets against the first.");
    bench::Table table({"kind", "unscaled", "non-uniform", "mirrored"});
    for (const ScaleRow& row : report.scales)
        table.row({row.kind, text("%.2f", row.plain),
                   text("%.2f (%.2f ×)", row.non_uniform, row.non_uniform / row.plain),
                   text("%.2f (%.2f ×)", row.mirrored, row.mirrored / row.plain)});
    page.table(table);
}

}  // namespace

void write_kinds(const Report& report, bench::Page& page) {
    page.heading(2, "Kinds");
    page.paragraph(
        "Displacement maps, line tables, direction maps and occlusion volumes beside ray casting and beside "
        "what else is used for this: "
        "what is asked of them, and what was measured. KB are thousands of bytes in memory, unless said "
        "otherwise.");
    write_asked(report, page);
    write_corners(report, page);
    write_plots(report, page);
    write_instances(report, page);
    write_scales(report, page);
}

cli::Json kinds_json(const Report& report) {
    using cli::significant;
    cli::Json json;
    for (const Asked& row : asked()) {
        const bench::Bound& bound = row.bound;
        cli::Json entry{{"figure", row.what}, {bound.at_least ? "at_least" : "at_most", bound.limit}};
        entry["aim"] = bound.aim ? cli::Json(*bound.aim) : cli::Json();
        const auto at = report.measured.find(row.figure);
        entry["measured"] = at != report.measured.end() ? cli::Json(significant(at->second)) : cli::Json();
        if (at != report.measured.end()) entry["met"] = bound.holds(bound.limit, at->second);
        json["asked"].push_back(entry);
    }
    for (const Row& row : report.rows) {
        cli::Json entry{
            {"model", row.model},
            {"kind", row.kind},
            {"size", row.size},
            {"peer", row.peer},
            {"shared_directions", row.shared},
            {"memory_bytes", row.memory_bytes},
            {"file_bytes", row.file_bytes},
            {"rms_grey", significant(row.rms)},
            {"max_grey", significant(row.max)},
            {"receivers", row.receivers},
            {"rays", row.rays},
            {"ns_per_ray", significant(row.ns_per_ray())},
            {"ns_per_receiver", significant(row.ns_per_receiver())},
            {"speedup", significant(row.speedup())},
            {"embree_ns_per_ray", significant(row.embree_seconds * 1e9 / static_cast<double>(row.rays))},
            {"embree_mode", row.embree_mode}};
        for (const LevelSeconds& level : row.levels)
            entry["speedup_by_instructions"][level.level] = significant(row.embree_seconds / level.seconds);
        json["corner"].push_back(entry);
    }
    for (const InstancesRow& row : report.instances)
        json["instances"].push_back({{"layout", row.layout},
                                     {"maps", row.maps},
                                     {"instances", row.instances},
                                     {"receivers", row.receivers},
                                     {"rays", row.rays},
                                     {"frame_ms", significant(row.frame_seconds * 1e3)},
                                     {"embree_ms", significant(row.embree_seconds * 1e3)},
                                     {"embree_mode", row.embree_mode},
                                     {"speedup", significant(row.speedup())},
                                     {"rms_grey", significant(row.rms)},
                                     {"one_moved_ms", significant(row.moved_seconds * 1e3)},
                                     {"one_moved_receivers", significant(row.moved_receivers)},
                                     {"one_thread_ms", significant(row.one_thread_seconds * 1e3)},
                                     {"two_threads_ms", significant(row.two_threads_seconds * 1e3)}});
    for (const ScaleRow& row : report.scales)
        json["scales"].push_back({{"kind", row.kind},
                                  {"rms_grey", significant(row.plain)},
                                  {"rms_grey_non_uniform", significant(row.non_uniform)},
                                  {"rms_grey_mirrored", significant(row.mirrored)}});
    return json;
}

void say_progress(const std::string& what) {
    std::fprintf(stderr, "kinds: %s\n", what.c_str());
}

Report measure_kinds(paper::Lab& lab) {
    Report report;
    measure_corners(lab, report);
    measure_instances(lab, report);
    measure_scales(lab, report);
    return report;
}

}  // namespace dfield::kinds
