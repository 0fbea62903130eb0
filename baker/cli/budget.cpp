#include "baker/cli/budget.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>

#include "baker/cli/arguments.hpp"
#include "baker/cli/kinds_report.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "format/file.hpp"
#include "format/writer.hpp"

namespace dfield::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of a loaded field beside its kinds: the object itself and its provenance take less.
constexpr std::uint64_t kFieldBytes = 1536;

// Beyond this the search bakes coarse fields first, and only the most promising families at full size.
constexpr std::uint64_t kCoarseBudget = 192 << 10;
constexpr std::size_t kFineFamilies = 3;

// Bytes in memory once loaded: what the runtime keeps beside the payload is counted too.
std::uint64_t loaded_bytes(const FieldPlan& plan) {
    std::uint64_t bytes = kFieldBytes + plan_bytes(plan);
    if (plan.maps) bytes += position_count(*plan.maps) * sizeof(glm::vec3);
    if (plan.lines && plan.lines->pivot)
        bytes += lattice_point_count(plan.lines->lattice) * sizeof(glm::vec4);
    return bytes;
}

// Plans that differ in one size, which grows until the budget is full.
struct Family {
    dfield_kind kind;
    std::function<FieldPlan(std::uint32_t size)> plan;
    std::uint32_t largest;

    std::optional<FieldPlan> fill(std::uint64_t budget) const {
        std::optional<FieldPlan> best;
        for (std::uint32_t size = 1; size <= largest; ++size) {
            const FieldPlan larger = plan(size);
            if (!plan_error(larger).empty()) continue;  // too small for its kind, or beyond the format
            if (loaded_bytes(larger) > budget) break;
            best = larger;
        }
        return best;
    }
};

Family map_family(std::uint32_t map_size, std::uint32_t bits) {
    const auto plan = [=](std::uint32_t subdivision) {
        FieldParameters maps;
        maps.subdivision = subdivision;
        maps.map_size = map_size;
        maps.bits = bits;
        return FieldPlan{.maps = maps};
    };
    return {DFIELD_KIND_MAPS, plan, kMaxSubdivision};
}

enum class LineLookup { kNearest, kPivot, kFiltered };

Family line_family(LineLookup lookup, bool ellipsoid, std::uint32_t depth_bits) {
    const auto plan = [=](std::uint32_t lattice) {
        LineParameters lines;
        lines.lattice = lattice;
        lines.pivot = lookup == LineLookup::kPivot;
        lines.filtered = lookup == LineLookup::kFiltered;
        lines.ellipsoid = ellipsoid;
        lines.depth_bits = depth_bits;
        // Depths are asked less often, and in error by less, than whether there is a hit.
        lines.depth_lattice = depth_bits == 0 ? 0 : std::max(kMinLineLattice, lattice / 2);
        return FieldPlan{.lines = lines};
    };
    return {DFIELD_KIND_LINES, plan, kMaxLineLattice};
}

Family direction_family(std::uint32_t map_size, std::uint32_t depth_size) {
    const auto plan = [=](std::uint32_t subdivision) {
        return FieldPlan{.directions = {{subdivision, map_size, depth_size}}};
    };
    return {DFIELD_KIND_DIRECTIONS, plan, kMaxDirectionSubdivision};
}

Family volume_family() {
    return {DFIELD_KIND_VOLUME,
            [](std::uint32_t size) { return FieldPlan{.volume = VolumeParameters{size}}; }, kMaxVolumeSize};
}

// What is worth trying. Between directions or positions and texels there is a best balance, which moves with
// the object and the budget; depths cost accuracy in the open, and are there for the figures in contact.
// Occlusion volumes are tried where they are asked for: at equal bytes the other kinds are more accurate.
std::vector<Family> families(dfield_kind kind) {
    if (kind == DFIELD_KIND_VOLUME) return {volume_family()};
    std::vector<Family> all;
    for (const std::uint32_t map_size : {16u, 32u, 64u, 128u}) all.push_back(direction_family(map_size, 0));
    for (const std::uint32_t map_size : {32u, 64u}) all.push_back(direction_family(map_size, 8));
    for (const LineLookup lookup : {LineLookup::kFiltered, LineLookup::kPivot, LineLookup::kNearest})
        all.push_back(line_family(lookup, true, 0));
    all.push_back(line_family(LineLookup::kFiltered, false, 0));
    all.push_back(line_family(LineLookup::kFiltered, true, 4));
    for (const std::uint32_t map_size : {16u, 24u, 32u, 48u}) all.push_back(map_family(map_size, 1));
    all.push_back(map_family(24, 8));
    if (kind != DFIELD_KIND_AUTO)
        std::erase_if(all, [&](const Family& family) { return family.kind != kind; });
    return all;
}

class Search {
  public:
    Search(const TriangleMesh& mesh, const BudgetOptions& options)
        : mesh_(mesh),
          options_(options),
          context_(options.threads),
          corner_(mesh, kStandardScenes[0].gap, options.threads),
          contact_(mesh, kStandardScenes[1].gap, options.threads) {}

    // Tries each family at this size; those of them that fit, the most accurate first.
    std::vector<Family> rank(const std::vector<Family>& tried, std::uint64_t budget) {
        std::vector<std::pair<std::size_t, Family>> fitting;
        for (std::size_t i = 0; i < tried.size(); ++i) {
            progress_.update(i, tried.size());
            const std::optional<FieldPlan> plan = tried[i].fill(budget);
            if (!plan || !measure(tried[i].kind, *plan, budget)) continue;
            fitting.emplace_back(candidates.size() - 1, tried[i]);
        }
        std::stable_sort(fitting.begin(), fitting.end(),
                         [&](const auto& a, const auto& b) { return better(a.first, b.first); });
        std::vector<Family> ranked;
        for (const auto& [candidate, family] : fitting) ranked.push_back(family);
        return ranked;
    }

    bool better(std::size_t a, std::size_t b) const {
        const auto hundredths = [&](std::size_t i) {
            return std::lround(100 * candidates[i].corner.rms_grey);
        };
        if (hundredths(a) != hundredths(b)) return hundredths(a) < hundredths(b);
        return candidates[a].memory_bytes < candidates[b].memory_bytes;
    }

    std::vector<BudgetCandidate> candidates;

  private:
    // False where it does not fit after all.
    bool measure(dfield_kind kind, const FieldPlan& plan, std::uint64_t budget) {
        if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        const auto start = Clock::now();
        BakeOptions bake;
        bake.threads = options_.threads;
        bake.cancel = &interrupted;
        const DisplacementField field = bake_plan(mesh_, plan, bake);
        const std::vector<std::byte> bytes = write_field(field, {.zstd_level = 1});
        const Field loaded = Field::load(context_.get(), bytes.data(), bytes.size());
        if (loaded.info().memory_bytes > budget) return false;
        const FileInfo file = read_file_info(bytes);
        BudgetCandidate& added = candidates.emplace_back();
        added.kind = kind;
        added.plan = plan;
        added.memory_bytes = loaded.info().memory_bytes;
        added.description = kind_lines(field, file).front().description;
        added.parameters = kinds_json(field, file).front();
        added.corner = corner_.measure(context_.get(), loaded, kind);
        added.corner_contact = contact_.measure(context_.get(), loaded, kind);
        added.seconds = seconds_since(start);
        return true;
    }

    const TriangleMesh& mesh_;
    const BudgetOptions& options_;
    ThreadedContext context_;
    AccuracyScene corner_, contact_;
    ProgressBar progress_{"choosing", "candidate", options_.quiet};
};

Error too_small(const BudgetOptions& options) {
    const std::string beside =
        options.reserved > 0 ? ", and " + std::to_string(options.reserved) + " for --self" : "";
    return {ExitCode::kUsage, "--budget " + std::to_string(options.budget) +
                                  ": not even the smallest field fits; take 4K or more" + beside};
}

}  // namespace

void add_budget_option(CLI::App& command, std::uint64_t& budget) {
    CLI::Option* option = command.add_option(
        "--budget", budget,
        "Choose kind, resolutions and bits for the lowest error within so many bytes of memory (128K, 1M; "
        "K = 1024): fields that fill the budget are baked and measured, and the one with the smallest RMS "
        "error "
        "in scene corner, every kind asked about the same 512 directions, wins; equal ones by bytes. --kind "
        "maps, lines or directions restricts the choice, --kind volume takes the largest volume that fits");
    option->transform(CLI::AsSizeValue(false))
        ->check(CLI::PositiveNumber)
        ->type_name("BYTES")
        ->group("Field");
    for (const char* flag :
         {"--subdivision", "--map-size", "--mapping", "--positions", "--bits", "--direction-count",
          "--direction-size", "--direction-levels", "--direction-depth", "--line-size", "--line-bits",
          "--line-depth-size", "--line-lookup", "--line-space", "--volume-size"})
        option->excludes(flag);
}

BudgetChoice choose_within_budget(const TriangleMesh& mesh, const BudgetOptions& options) {
    const auto start = Clock::now();
    const std::vector<Family> all = families(options.kind);
    const std::uint64_t budget = options.budget - std::min(options.budget, options.reserved);
    if (std::none_of(all.begin(), all.end(), [&](const Family& family) { return family.fill(budget); }))
        throw too_small(options);
    Search search(mesh, options);
    const std::vector<Family> ranked = search.rank(all, std::min(budget, kCoarseBudget));
    if (budget > kCoarseBudget)
        search.rank({ranked.begin(), ranked.begin() + std::min(kFineFamilies, ranked.size())}, budget);
    if (search.candidates.empty()) throw too_small(options);
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < search.candidates.size(); ++i)
        if (search.better(i, chosen)) chosen = i;
    return {options.budget, std::move(search.candidates), chosen, seconds_since(start)};
}

Json BudgetChoice::json() const {
    Json tried = Json::array();
    for (const BudgetCandidate& candidate : candidates) {
        Json json = candidate.parameters;
        json["memory_bytes"] = candidate.memory_bytes;
        json[kStandardScenes[0].name] = candidate.corner.json();
        json[kStandardScenes[1].name] = candidate.corner_contact.json();
        json["seconds"] = significant(candidate.seconds, 3);
        tried.push_back(std::move(json));
    }
    return {
        {"bytes", budget}, {"chosen", chosen}, {"seconds", significant(seconds, 3)}, {"candidates", tried}};
}

std::vector<std::string> BudgetChoice::lines() const {
    std::vector<std::string> lines{
        text("budget %s: %zu candidates in %.1f s; error in grey RMS, corner / contact",
             bytes_text(budget).c_str(), candidates.size(), seconds)};
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const BudgetCandidate& candidate = candidates[i];
        lines.push_back(text("%s %6.2f / %6.2f  %-10s %s", i == chosen ? "->" : "  ",
                             candidate.corner.rms_grey, candidate.corner_contact.rms_grey,
                             name_of(candidate.kind), candidate.description.c_str()));
    }
    return lines;
}

}  // namespace dfield::cli
