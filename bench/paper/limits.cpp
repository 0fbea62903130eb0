// What the project asks of itself, and what was measured.
#include <array>
#include <thread>

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
    void at_most(const std::string& what, double asked, double measured, const char* format) {
        row(what, "<= ", asked, measured, format, measured <= asked);
    }
    void at_least(const std::string& what, double asked, double measured, const char* format) {
        row(what, ">= ", asked, measured, format, measured >= asked);
    }
    const Table& table() const { return table_; }

  private:
    void row(const std::string& what, const char* relation, double asked, double measured, const char* format,
             bool met) {
        char asked_text[64], measured_text[64];
        std::snprintf(asked_text, sizeof asked_text, format, asked);
        std::snprintf(measured_text, sizeof measured_text, format, measured);
        table_.row({what, relation + std::string(asked_text), measured_text, met ? "yes" : "**no**"});
    }

    Table table_{{"limit", "asked", "measured", "met"}};
};

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
                           "%.2f");
        }
    for (const SizeLimit& limit : kSizes)
        if (const Model* model = lab.find(limit.model))
            limits.at_most(
                "file, " + title(limit.model, limit.bits), static_cast<double>(limit.bytes),
                static_cast<double>(lab.baked(*model, lab.parameters(32, 32, limit.bits)).bytes.size()),
                "%.0f bytes");
    if (const Model* bunny = lab.find("bunny")) {
        const Baked& field = lab.baked(*bunny, lab.parameters());
        limits.at_least("bake, bunny, one core", kBakeRate, field.mrays_per_s(), "%.1f Mray/s");
        const Duel times =
            duel(bunny->mesh, field.bytes, lab.receivers(*bunny, Room::kGap), rays, lab.rounds(7));
        limits.at_least("lookup against " + times.embree_mode + ", bunny, one core", kSpeedup,
                        times.speedup(), "%.2f x");
    }
    limits.at_most("lookup, " + million.model->name + " with " + grouped(million.triangles) +
                       " triangles against " + grouped(million.model->mesh.triangles.size()),
                   1 + kLookupRatio, million.lookup_ratio(), "%.3f x");
    page.table(limits.table());
}

}  // namespace dfield::paper
