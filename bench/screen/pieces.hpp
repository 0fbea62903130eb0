// The chapter about screen space in pieces. Each measures its figures and writes its part of the page.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "baker/cli/screen_options.hpp"
#include "baker/cli/screen_runner.hpp"
#include "bench/common/page.hpp"

namespace dfield::screens {

using cli::Json;

struct Lab {
    std::filesystem::path models;  // the project's own
    const bench::Page& page;       // beside which pictures are saved
    bool quick = false;            // for tests: small pictures, few rays

    cli::CommonOptions common() const;
    cli::ReferenceOptions references() const;
    int rounds() const { return quick ? 1 : 9; }
    // A scene of the folder; full: the size when not quick.
    cli::ScreenInput input(const std::string& file, const std::string& size) const;
};

struct Piece {
    const char* name;
    Json (*measure)(const Lab& lab);
    void (*write)(const Json& figures, bench::Page& page);  // this piece's figures
};

// 16 samples by the base disk, interleaved and filtered, of this radius: what is asked of everything.
dfield_screen_desc usual_desc(float radius);

Json measure_errors(const Lab& lab);
void write_errors(const Json& figures, bench::Page& page);
Json measure_tangent(const Lab& lab);
void write_tangent(const Json& figures, bench::Page& page);
Json measure_speed(const Lab& lab);
void write_speed(const Json& figures, bench::Page& page);
Json draw_figure1(const Lab& lab);
void write_figure1(const Json& figures, bench::Page& page);
Json draw_figure7(const Lab& lab);
void write_figure7(const Json& figures, bench::Page& page);
Json draw_figure8(const Lab& lab);
void write_figure8(const Json& figures, bench::Page& page);
Json draw_figure9(const Lab& lab);
void write_figure9(const Json& figures, bench::Page& page);
Json measure_far(const Lab& lab);
void write_far(const Json& figures, bench::Page& page);

}  // namespace dfield::screens
