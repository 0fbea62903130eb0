// dfield_paper: measures everything that the paper's evaluation shows and writes it as a page with pictures.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>

#include "baker/cli/report.hpp"
#include "bench/common/machine.hpp"
#include "bench/cutting/chapter.hpp"
#include "bench/kinds/report.hpp"
#include "bench/paper/figures.hpp"
#include "bench/screen/chapter.hpp"

namespace dfield::paper {
namespace {

struct Options {
    std::filesystem::path output = "docs/results.md", own = "models", shared = "../shared/models",
                          scans = "../shared/volumes";
    std::string only;
    bool quick = false;
};

void write_introduction(const Lab& lab, Page& page) {
    page.heading(1, "Results: the paper's evaluation");
    page.paragraph(
        "The tables and pictures of Gaitatzes, Chrysanthou and Papaioannou, \"Presampled Visibility for "
        "Ambient Occlusion\" (Journal of WSCG, 2008), measured with this implementation, and what this "
        "project asks of itself. Measured on " +
        bench::processor_name() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores; " +
        bench::compiler_version() + "; Embree " + bench::embree_version() +
        ". This page and its pictures are written by one command:");
    page.preformatted("scripts/results");
    if (lab.quick())
        page.paragraph("**Written with --quick: small fields, few rays, one round. No figure here counts.**");
    if (!lab.missing().empty()) {
        std::string names;
        for (const std::string& name : lab.missing()) names += (names.empty() ? "" : ", ") + name;
        page.paragraph("**Models that were not there, whose rows are left out: " + names + ".**");
    }
    page.paragraph(
        "Scene: three planes of 33 × 33 vertices with sides of twice the longest side of the caster's box, a "
        "tenth of that side away from it (\"in contact\": touching it), " +
        std::to_string(lab.directions(Rays::kConcentric).directions.size()) +
        " rays a vertex, only the caster occludes. Errors are of visibility in grey levels 0 to 255, against "
        "Embree with the same rays. Times are of one core; contestants take turns, and the fastest turn of "
        "each counts.");
}

void say(const char* what) {
    std::printf("%s\n", what);
    std::fflush(stdout);
}

void write_kinds(Lab& lab, Page& page) {
    say("kinds");
    kinds::write_kinds(kinds::measure_kinds(lab), page);
}

void write_volumes(const volumes::Chapter& chapter, const Options& options, Page& page) {
    say(chapter.name);
    volumes::Lab lab{volumes::Stock(options.scans, options.quick), page, options.own};
    volumes::Json figures;
    volumes::measure_pieces(chapter, lab, {}, figures);
    volumes::write_chapter(chapter, figures, options.quick, page);
}

void write_screen(const Options& options, Page& page) {
    say("screen");
    screens::write_screen({options.own, page, options.quick}, page);
}

void run_chapter(const Options& options) {
    Page page(options.output);
    if (options.only == "volumes") {
        write_volumes(volumes::sweeping_chapter(), options, page);
    } else if (options.only == "cutting") {
        write_volumes(cutting::cutting_chapter(), options, page);
    } else if (options.only == "screen") {
        write_screen(options, page);
    } else {
        Lab lab(options.own, options.shared, options.quick);
        write_kinds(lab, page);
    }
    page.save_chapter();
}

void run(const Options& options) {
    Lab lab(options.own, options.shared, options.quick);
    Page page(options.output);
    write_introduction(lab, page);
    say("limits");
    const Million million = measure_million(lab);
    write_limits(lab, million, page);
    say("figure 2");
    write_figure2(lab, page);
    say("figure 4");
    write_figure4(lab, page);
    say("figure 5");
    write_figure5(lab, page);
    say("figure 6");
    write_figure6(lab, page);
    say("figure 7");
    write_figure7(lab, page);
    say("figure 8");
    write_figure8(lab, million, page);
    write_several_objects(lab, page);
    say("ablation");
    write_ablation(lab, page);
    write_kinds(lab, page);
    write_volumes(volumes::sweeping_chapter(), options, page);
    write_volumes(cutting::cutting_chapter(), options, page);
    write_screen(options, page);
    page.save();
    std::printf("%s\n", options.output.string().c_str());
}

}  // namespace

std::string maps_text(const FieldParameters& parameters) {
    return grouped(paper_position_count(parameters)) + " maps of " + square(parameters.map_size);
}

}  // namespace dfield::paper

int main(int argc, char** argv) {
    dfield::paper::Options options;
    CLI::App app("Measures what the paper's evaluation shows and writes it as a page with pictures");
    app.add_option("--output", options.output, "The page; its pictures go into a folder named like it")
        ->capture_default_str();
    app.add_option("--models", options.own, "The project's own models")
        ->check(CLI::ExistingDirectory)
        ->capture_default_str();
    app.add_option("--shared", options.shared, "The paper's models; rows are left out where they are missing")
        ->capture_default_str();
    app.add_option("--shared-volumes", options.scans,
                   "The scans; what needs them is left out where they are missing")
        ->capture_default_str();
    app.add_option("--only", options.only, "This chapter alone; the page's others stay as they are")
        ->check(CLI::IsMember({"kinds", "volumes", "cutting", "screen"}));
    app.add_flag("--quick", options.quick, "For tests: own models only, small fields, few rays, one round");
    CLI11_PARSE(app, argc, argv);
    try {
        if (options.only.empty())
            dfield::paper::run(options);
        else
            dfield::paper::run_chapter(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "dfield_paper: %s\n", error.what());
        return 1;
    }
}
