// `--budget`: which kind of field, of what sizes, is the most accurate within some bytes of memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/cli/accuracy.hpp"
#include "baker/cli/app_fwd.hpp"
#include "baker/plan.hpp"

namespace dfield::cli {

// --budget BYTES, in place of the flags of add_plan_options(), --kind apart.
void add_budget_option(CLI::App& command, std::uint64_t& budget);

// One field that was baked and measured.
struct BudgetCandidate {
    dfield_kind kind;
    FieldPlan plan;
    std::uint64_t memory_bytes;  // dfield_field_info's
    std::string description;     // for people
    Json parameters;             // as in reports of bakes
    Accuracy corner, corner_contact;
    double seconds;  // to bake and measure it
};

struct BudgetChoice {
    std::uint64_t budget;
    std::vector<BudgetCandidate> candidates;  // in the order tried; at least one
    std::size_t chosen;                       // index of the winner
    double seconds;

    const BudgetCandidate& winner() const { return candidates[chosen]; }
    Json json() const;
    std::vector<std::string> lines() const;  // for people
};

struct BudgetOptions {
    std::uint64_t budget;
    // The kind to stay with; AUTO tries all.
    dfield_kind kind = DFIELD_KIND_AUTO;
    std::uint64_t reserved = 0;  // bytes of the budget for self visibilities
    int threads = 0;
    bool quiet = false;
};

// Bakes fields that fill the budget and takes the one with the smallest RMS error in scene `corner`; of those
// that are equal in hundredths of a grey level, the smallest. Deterministic. Throws Error(kUsage) where not
// even the smallest field fits.
BudgetChoice choose_within_budget(const TriangleMesh& mesh, const BudgetOptions& options);

}  // namespace dfield::cli
