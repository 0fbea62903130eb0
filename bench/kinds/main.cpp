// dfield_kinds: measures the kinds of section beside their peers, as JSON and as a page with plots.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/common/machine.hpp"
#include "bench/kinds/report.hpp"

int main(int argc, char** argv) {
    std::filesystem::path output, own = "models", shared = "../shared/models";
    std::string json = "-";
    bool quick = false;
    CLI::App app(
        "Measures displacement maps, line tables, direction maps and occlusion volumes beside Embree, "
        "distance "
        "fields and grids of caps");
    app.add_option("--output", output, "A Markdown page; its plots go into a folder named like it");
    app.add_option("--json", json, "The figures as JSON: a file, or - for stdout")->capture_default_str();
    app.add_option("--models", own, "The project's own models")
        ->check(CLI::ExistingDirectory)
        ->capture_default_str();
    app.add_option("--shared", shared, "The paper's models; rows are left out where they are missing")
        ->capture_default_str();
    app.add_flag("--quick", quick,
                 "For tests: own models only, small sizes, one round; figures that mean nothing");
    CLI11_PARSE(app, argc, argv);
    try {
        dfield::paper::Lab lab(own, shared, quick);
        const dfield::kinds::Report report = dfield::kinds::measure_kinds(lab);
        if (!output.empty()) {
            dfield::bench::Page page(output);
            dfield::kinds::write_kinds(report, page);
            page.save();
        }
        dfield::cli::Json figures{{"processor", dfield::bench::processor_name()},
                                  {"compiler", dfield::bench::compiler_version()},
                                  {"embree", dfield::bench::embree_version()},
                                  {"quick", quick}};
        figures.update(dfield::kinds::kinds_json(report));
        dfield::cli::write_json_report(json, figures);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "dfield_kinds: %s\n", error.what());
        return 1;
    }
}
