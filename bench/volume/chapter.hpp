// Chapters about volumes, in pieces. Each piece measures its figures, which are kept as JSON so that pieces
// can be measured in runs of their own, and writes its part of the page from them.
#pragma once

#include <filesystem>
#include <span>

#include "baker/cli/report.hpp"
#include "bench/common/page.hpp"
#include "bench/volume/asked.hpp"
#include "bench/volume/subjects.hpp"

namespace dfield::volumes {

using cli::Json;

struct Lab {
    Stock stock;
    const bench::Page& page;       // beside which pictures are saved
    std::filesystem::path models;  // the project's own, with its transfer functions
};

struct Piece {
    const char* name;
    Json (*measure)(Lab& lab);
    // All figures that were measured; this piece's are under its name. Null where another piece writes them.
    void (*write)(const Json& figures, bench::Page& page);
};

struct Chapter {
    const char* name;  // of its table of what is asked
    const char *title, *introduction;
    std::span<const Piece> pieces;  // in the page's order
    std::span<const Asked> asked;
};
const Chapter& sweeping_chapter();

// Measures the pieces that `wanted` names, all where it is empty, into `figures`; those of other pieces stay.
// What it is at goes to stderr. Throws std::invalid_argument for a name that no piece has.
void measure_pieces(const Chapter& chapter, Lab& lab, std::span<const std::string> wanted, Json& figures);

// The chapter from the figures; says what is missing.
void write_chapter(const Chapter& chapter, const Json& figures, bool quick, bench::Page& page);

}  // namespace dfield::volumes
