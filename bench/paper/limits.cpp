// What the project asks of itself, and what was measured.
#include <algorithm>
#include <array>

#include "baker/cli/report.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

using cli::text;

constexpr double kContactFactor = 1.6;

struct AccuracyLimit {
    const char* model;
    std::uint32_t bits;
    double rms;
};
constexpr std::array<AccuracyLimit, 4> kAccuracy{
    {{"bunny", 8, 2.3}, {"bunny", 1, 2.8}, {"igea", 8, 1.5}, {"cube with a hole", 8, 4.0}}};

struct SizeLimit {
    const char* model;
    std::uint32_t bits;
    std::uint64_t bytes;
};
constexpr std::array<SizeLimit, 3> kSizes{{{"bunny", 8, 1000000}, {"bunny", 1, 80000}, {"igea", 8, 1200000}}};

constexpr double kBakeRate = 6, kLookupRatio = 0.10, kSpeedup = 1.2;

std::string title(const char* model, std::uint32_t bits) {
    return std::string(model) + ", " + std::to_string(bits) + " bit";
}

class LimitTable {
  public:
    template<class Format>
    void at_most(const std::string& what, double asked, double measured, const Format& format) {
        table_.row({what, "≤ " + format(asked), format(measured), yes_or_no(measured <= asked)});
    }
    template<class Format>
    void at_least(const std::string& what, double asked, double measured, const Format& format) {
        table_.row({what, "≥ " + format(asked), format(measured), yes_or_no(measured >= asked)});
    }
    const Table& table() const { return table_; }

  private:
    static std::string yes_or_no(bool met) { return met ? "yes" : "**no**"; }

    Table table_{{"limit", "asked", "measured", "met"}};
};

std::string grey(double value) {
    return text("%.2f", value);
}
std::string bytes(double value) {
    return grouped(static_cast<std::uint64_t>(value)) + " bytes";
}
std::string rate(double value) {
    return text("%.1f Mray/s", value);
}
std::string times(double value) {
    return text("%.2f ×", value);
}

double bake_rate(const Lab& lab, const Model& model) {
    double best = 0;
    for (int round = 0; round < lab.rounds(3); ++round)
        best = std::max(best, lab.timed_bake(model.mesh, lab.parameters()).mrays_per_s());
    return best;
}

}  // namespace

void write_limits(Lab& lab, const Million& million, Page& page) {
    page.heading(2, "The project's own limits");
    page.paragraph(
        maps_text(lab.parameters()) +
        ". RMS is in grey levels of 255 over all receivers of the corner, against ray casting with "
        "the same rays.");
    LimitTable limits;
    const Directions& rays = lab.directions(Rays::kConcentric);
    for (const Room room : {Room::kGap, Room::kContact})
        for (const AccuracyLimit& limit : kAccuracy) {
            const Model* model = lab.find(limit.model);
            if (!model) continue;
            Lookup lookup(lab.baked(*model, lab.parameters(32, 32, limit.bits)).bytes,
                          lab.receivers(*model, room), rays);
            lookup.run();
            const bool contact = room == Room::kContact;
            limits.at_most("RMS, " + title(limit.model, limit.bits) + (contact ? ", in contact" : ""),
                           limit.rms * (contact ? kContactFactor : 1),
                           errors_of(lookup.visibility(), lab.ray_cast(*model, room, Rays::kConcentric)).rms,
                           grey);
        }
    for (const SizeLimit& limit : kSizes)
        if (const Model* model = lab.find(limit.model))
            limits.at_most(
                "file, " + title(limit.model, limit.bits), static_cast<double>(limit.bytes),
                static_cast<double>(lab.baked(*model, lab.parameters(32, 32, limit.bits)).bytes.size()),
                bytes);
    if (const Model* bunny = lab.find("bunny")) {
        limits.at_least("bake, bunny, one core", kBakeRate, bake_rate(lab, *bunny), rate);
        const Duel result = duel(bunny->mesh, lab.baked(*bunny, lab.parameters()).bytes,
                                 lab.receivers(*bunny, Room::kGap), rays, lab.rounds(9));
        limits.at_least("lookup against " + result.embree_mode + ", bunny, one core", kSpeedup,
                        result.speedup(), times);
    }
    limits.at_most("lookup, " + million.model->name + " with " + grouped(million.triangles) +
                       " triangles against " + grouped(million.model->mesh.triangles.size()),
                   1 + kLookupRatio, million.lookup_ratio(), times);
    page.table(limits.table());
}

}  // namespace dfield::paper
