// dfield_volumes: measures sweeping or cutting, whole or in pieces, as JSON and as the page's chapter.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "bench/cutting/chapter.hpp"

namespace {

dfield::cli::Json read_figures(const std::string& file) {
    std::ifstream stream(file);
    return stream ? dfield::cli::Json::parse(stream) : dfield::cli::Json::object();
}

}  // namespace

int main(int argc, char** argv) {
    std::filesystem::path output = "docs/results.md", shared = "../shared/volumes", models = "models";
    std::string figures_file, name = "sweeping";
    std::vector<std::string> wanted;
    bool quick = false, list = false;
    CLI::App app(
        "Measures distance fields and occlusion by sweeping, or local and contextual ambient occlusion, and "
        "writes the page's chapter about them");
    app.add_option(
           "--output", output,
           "The page whose chapter is written or written again; pictures go into a folder named like it")
        ->capture_default_str();
    app.add_option("--shared", shared, "The scans; what needs them is left out where they are missing")
        ->capture_default_str();
    app.add_option("--models", models, "The project's own models, with the transfer functions")
        ->capture_default_str();
    app.add_option("--chapter", name, "Sweeping volumes, or cutting them")
        ->capture_default_str()
        ->check(CLI::IsMember({"sweeping", "cutting"}));
    app.add_option(
        "--figures", figures_file,
        "A JSON file of figures: pieces that are not measured now are taken from it, and those that are "
        "are put into it");
    app.add_option("--only", wanted, "The pieces to measure")->delimiter(',');
    app.add_flag("--list", list, "The pieces' names");
    app.add_flag("--quick", quick, "For tests: own volumes only, small, few rays");
    CLI11_PARSE(app, argc, argv);
    try {
        const dfield::volumes::Chapter& chapter =
            name == "cutting" ? dfield::cutting::cutting_chapter() : dfield::volumes::sweeping_chapter();
        if (list) {
            for (const dfield::volumes::Piece& piece : chapter.pieces) std::puts(piece.name);
            return 0;
        }
        dfield::bench::Page page(output);
        dfield::volumes::Lab lab{dfield::volumes::Stock(shared, quick), page, models};
        dfield::cli::Json figures = read_figures(figures_file);
        dfield::volumes::measure_pieces(chapter, lab, wanted, figures);
        if (!figures_file.empty()) dfield::cli::write_json_report(figures_file, figures);
        dfield::volumes::write_chapter(chapter, figures, quick, page);
        page.save_chapter();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "dfield_volumes: %s\n", error.what());
        return 1;
    }
}
