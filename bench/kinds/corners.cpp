// Each kind and each peer in the paper's corner, model by model.
#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>

#include "bench/common/turns.hpp"
#include "bench/kinds/contest.hpp"
#include "bench/kinds/distance_field.hpp"
#include "bench/kinds/occlusion_grid.hpp"
#include "bench/kinds/report.hpp"
#include "bench/kinds/specimens.hpp"
#include "bench/paper/measure.hpp"
#include "bench/paper/subdivide.hpp"

namespace dfield::kinds {
namespace {

constexpr double kTurnSeconds = 1e-3;

constexpr std::size_t kManyTriangles = 1000000;
constexpr const char* kMillion = "igea, subdivided";
constexpr int kRounds = 5;
constexpr dfield_simd kLevels[] = {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON};

// One instance at its place, looked up at one level of instructions.
class FieldContest {
  public:
    FieldContest(std::span<const std::byte> bytes, const Pairs& pairs, dfield_kind kind,
                 const paper::Receivers& receivers, dfield_simd level)
        : receivers_(receivers),
          context_(capped_context(level)),
          field_(Field::load(context_, bytes.data(), bytes.size())),
          ao_(context_, pairs.desc(kind)),
          scene_(context_),
          visibility_(receivers.size()) {
        const glm::mat4 identity(1);
        scene_.add(field_, &identity[0][0]);
    }

    // The fastest of the calls that fit into as long as a part of Embree's turn takes, so that both find what
    // they read in the caches.
    void turn() {
        double spent = 0;
        do {
            const double seconds =
                bench::seconds_of([&] { scene_.visibility(ao_, receivers_.view(), visibility_.data()); });
            seconds_ = std::min(seconds_, seconds);
            spent += seconds;
        } while (spent < kTurnSeconds);
    }
    dfield_simd level() const { return context_.simd(); }
    double seconds() const { return seconds_; }
    const std::vector<float>& visibility() const { return visibility_; }
    std::uint64_t memory_bytes() const { return field_.info().memory_bytes; }

  private:
    const paper::Receivers& receivers_;
    Context context_;
    Field field_;
    Ao ao_;
    Scene scene_;
    double seconds_ = std::numeric_limits<double>::infinity();
    std::vector<float> visibility_;
};

struct PeerContest {
    Row row;
    std::function<std::vector<float>(const paper::Receivers&)> run;
    std::vector<paper::Receivers> receivers;  // in parts, as Embree has them where it takes long
    std::vector<double> seconds{};            // of each
    std::vector<float> visibility{};

    void turn() {
        seconds.resize(receivers.size(), std::numeric_limits<double>::infinity());
        visibility.clear();
        for (std::size_t part = 0; part < receivers.size(); ++part) {
            std::vector<float> values;
            seconds[part] =
                std::min(seconds[part], bench::seconds_of([&] { values = run(receivers[part]); }));
            visibility.insert(visibility.end(), values.begin(), values.end());
        }
        row.seconds = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    }
};

std::vector<paper::Receivers> in_parts(const paper::Receivers& receivers) {
    std::vector<paper::Receivers> parts;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        if (i % kReceiversAPart == 0) parts.emplace_back();
        parts.back().positions.push_back(receivers.positions[i]);
        parts.back().normals.push_back(receivers.normals[i]);
    }
    return parts;
}

void add_peers(const paper::Lab& lab, const TriangleMesh& mesh, const paper::Receivers& receivers,
               const Pairs& pairs, const std::vector<float>& reference, bool sweep,
               std::vector<PeerContest>& contests) {
    const auto add = [&](const char* kind, std::uint32_t size, const char* suffix, bool headline,
                         std::uint64_t bytes, bool whole,
                         std::function<std::vector<float>(const paper::Receivers&)> run) {
        Row row;
        row.kind = kind;
        row.size = std::to_string(size) + "³" + suffix;
        row.headline = headline;
        row.peer = true;
        row.memory_bytes = bytes;
        contests.push_back({std::move(row), std::move(run),
                            whole ? std::vector<paper::Receivers>{receivers} : in_parts(receivers)});
    };
    for (const std::uint32_t full : {16u, 24u, 32u, 64u}) {
        const bool headline = full == 32 || full == 64;
        if (!headline && !sweep) continue;
        const std::uint32_t size = lab.quick() ? full / 2 : full;
        // With a sign and without: the best stands for the method.
        std::shared_ptr<DistanceField> best;
        double least = std::numeric_limits<double>::infinity();
        const char* suffix = "";
        for (const Inside inside : {Inside::kVotes, Inside::kNowhere, Inside::kNowhereThick}) {
            auto field = std::make_shared<DistanceField>(mesh, DistanceFieldParameters{size, inside});
            const double rms =
                paper::errors_of(field->visibility(receivers, pairs.directions), reference).rms;
            if (rms < least) {
                least = rms, best = field;
                suffix = inside == Inside::kVotes ? "" : ", unsigned";
            }
        }
        add("distance field", size, suffix, headline, best->memory_bytes(), false,
            [best, &pairs](const paper::Receivers& part) {
                return best->visibility(part, pairs.directions);
            });
    }
    for (const std::uint32_t full : {16u, 24u, 32u, 40u}) {
        if (full != 32 && !sweep) continue;
        const std::uint32_t size = lab.quick() ? full / 4 : full;
        const auto grid = std::make_shared<OcclusionGrid>(mesh, OcclusionGridParameters{size});
        add("grid of caps", size, "", full == 32, grid->memory_bytes(), true,
            [grid](const paper::Receivers& part) { return grid->visibility(part); });
    }
}

void finish(Row& row, const std::string& model, const paper::Receivers& receivers,
            const EmbreeContest& embree, const std::vector<float>& visibility) {
    const paper::Errors errors = paper::errors_of(visibility, embree.visibility());
    row.model = model;
    row.rms = errors.rms;
    row.max = errors.max;
    row.receivers = receivers.size();
    row.rays = embree.rays();
    row.embree_seconds = embree.seconds();
    row.embree_mode = embree.mode();
}

void measure_corner(const paper::Lab& lab, const std::string& model, const TriangleMesh& mesh,
                    const paper::Receivers& receivers, bool sweep, Report& report) {
    say_progress(model);
    const Pairs hemisphere = hemisphere_pairs(lab), shared = shared_pairs(lab);
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(mesh);
    scene.commit();
    EmbreeContest by_normal(scene, receivers, hemisphere, false), by_world(scene, receivers, shared, false);

    struct Entry {
        Row row;
        std::vector<std::unique_ptr<FieldContest>> levels;
    };
    std::vector<Entry> entries;
    for (const Specimen& specimen : specimens(lab, sweep)) {
        const std::vector<std::byte> bytes = baked_specimen(mesh, specimen);
        Entry& entry = entries.emplace_back();
        entry.row.kind = specimen.kind;
        entry.row.size = specimen.size;
        entry.row.headline = specimen.headline;
        entry.row.shared = specimen.shared();
        entry.row.file_bytes = bytes.size();
        const Pairs& pairs = specimen.shared() ? shared : hemisphere;
        if (specimen.headline)
            for (const dfield_simd level : kLevels) {
                auto contest =
                    std::make_unique<FieldContest>(bytes, pairs, specimen.forced, receivers, level);
                if (contest->level() == level) entry.levels.push_back(std::move(contest));
            }
        if (entry.levels.empty())
            entry.levels.push_back(
                std::make_unique<FieldContest>(bytes, pairs, specimen.forced, receivers, DFIELD_SIMD_BEST));
    }
    std::vector<PeerContest> peers;
    add_peers(lab, mesh, receivers, hemisphere, by_normal.visibility(), sweep, peers);

    for (int round = 0; round < lab.rounds(kRounds); ++round) {
        by_normal.turn();
        by_world.turn();
        for (Entry& entry : entries)
            for (const auto& contest : entry.levels) contest->turn();
        for (PeerContest& peer : peers) peer.turn();
    }
    for (Entry& entry : entries) {
        const FieldContest& best = *entry.levels.back();
        for (const auto& contest : entry.levels)
            entry.row.levels.push_back({simd_name(contest->level()), contest->seconds()});
        entry.row.seconds = best.seconds();
        entry.row.memory_bytes = best.memory_bytes();
        finish(entry.row, model, receivers, entry.row.shared ? by_world : by_normal, best.visibility());
        report.rows.push_back(entry.row);
    }
    for (PeerContest& peer : peers) {
        finish(peer.row, model, receivers, by_normal, peer.visibility);
        report.rows.push_back(peer.row);
    }
}

const Row* fastest(const Report& report, const std::string& model, const std::string& kind, double grey,
                   double bytes) {
    const Row* best = nullptr;
    for (const Row& row : report.rows)
        if (row.headline && row.model == model && row.kind.starts_with(kind) && row.rms <= grey &&
            static_cast<double>(row.memory_bytes) <= bytes && (!best || row.speedup() > best->speedup()))
            best = &row;
    return best;
}

void judge(Report& report) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    for (const Row& row : report.rows)
        if (row.model == "bunny" && row.kind == "displacement maps, 8 bit" && row.headline)
            report.measured[Figure::kMapsSpeedup] = row.speedup();
    if (const Row* row = fastest(report, "bunny", "line table", kLinesGrey, kAny))
        report.measured[Figure::kLinesSpeedup] = row->speedup();
    if (const Row* row = fastest(report, "bunny", "direction maps", kDirectionsGrey, kSmallBytes)) {
        report.measured[Figure::kDirectionsSpeedup] = row->speedup();
        for (const LevelSeconds& level : row->levels)
            if (level.level == "AVX2")
                report.measured[Figure::kDirectionsSpeedupAvx2] = row->embree_seconds / level.seconds;
    }
    // The same maps, whatever their error there.
    if (const Row* row = fastest(report, "cube with a hole", "direction maps", kAny, kSmallBytes))
        report.measured[Figure::kDirectionsSpeedupHole] = row->speedup();
    if (const Row* row = fastest(report, kMillion, "direction maps", kAny, kSmallBytes))
        report.measured[Figure::kDirectionsSpeedupMillion] = row->speedup();

    const auto least_error = [&](Figure figure, const char* model, double bytes) {
        for (const Row& row : report.rows) {
            if (row.model != model || row.peer || static_cast<double>(row.memory_bytes) > bytes) continue;
            const auto [at, added] = report.measured.emplace(figure, row.rms);
            if (!added) at->second = std::min(at->second, row.rms);
        }
    };
    least_error(Figure::kSmallErrorBunny, "bunny", kSmallBytes);
    least_error(Figure::kSmallErrorIgea, "igea", kSmallBytes);
    least_error(Figure::kSmallErrorTree, "lemon tree", kSmallBytes);
    least_error(Figure::kLargeErrorBunny, "bunny", kLargeBytes);
    least_error(Figure::kLargeErrorIgea, "igea", kLargeBytes);
    least_error(Figure::kLargeErrorTree, "lemon tree", kLargeBytes);
    for (const Row& row : report.rows)
        if (row.model == "bunny" && row.kind == "direction maps" && row.headline && row.size.ends_with("64²"))
            report.measured[Figure::kFileBytes] = static_cast<double>(row.file_bytes) * 1e-3;
}

}  // namespace

void measure_corners(paper::Lab& lab, Report& report) {
    std::vector<std::string> names{"bunny", "igea", "lemon tree", "cow", "cube with a hole", "mountain"};
    if (lab.quick()) names = {"cube with a hole", "leafy tree"};
    for (const std::string& name : names)
        if (const paper::Model* model = lab.find(name)) {
            const bool sweep = name == "bunny" || name == "igea" || name == "lemon tree" || lab.quick();
            measure_corner(lab, name, model->mesh, lab.receivers(*model, paper::Room::kGap), sweep, report);
        }
    if (const paper::Model* igea = lab.find("igea")) {
        TriangleMesh many = igea->mesh;
        while (many.triangles.size() < kManyTriangles) many = paper::subdivided(many);
        measure_corner(lab, kMillion, many, lab.receivers(*igea, paper::Room::kGap), false, report);
    }
    if (!lab.quick()) judge(report);
}

}  // namespace dfield::kinds
