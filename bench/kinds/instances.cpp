// Many instances: whole frames from scratch, one instance moved, two threads.
#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>

#include "baker/cli/runtime_scene.hpp"
#include "bench/common/turns.hpp"
#include "bench/kinds/contest.hpp"
#include "bench/kinds/layouts.hpp"
#include "bench/kinds/report.hpp"
#include "bench/kinds/specimens.hpp"
#include "bench/paper/measure.hpp"

namespace dfield::kinds {
namespace {

constexpr int kFrames = 8, kMoves = 24, kEmbreeTurns = 2, kThreadRounds = 6;

struct Layout {
    std::string name;
    std::vector<const paper::Model*> models;
    Specimen maps;  // of each model; within 160 KB
    std::function<std::vector<Placement>(std::uint32_t frame)> placements;
    paper::Receivers receivers;
};

// A layout with the fields of its models, looked up on some threads.
class Crowd {
  public:
    Crowd(const Layout& layout, const std::vector<std::vector<std::byte>>& fields, const Pairs& pairs,
          int threads)
        : layout_(layout),
          context_(threads),
          ao_(context_.get(), pairs.desc(DFIELD_KIND_DIRECTIONS)),
          scene_(context_.get()),
          set_(context_.get(), ao_, layout.receivers.view()) {
        for (const auto& bytes : fields)
            fields_.push_back(Field::load(context_.get(), bytes.data(), bytes.size()));
        for (const Placement& placement : layout.placements(0))
            ids_.push_back(scene_.add(fields_[placement.object], &placement.transform[0][0]));
    }

    // Seconds from the transforms' change to all receivers' visibility. The receivers stay from frame to
    // frame, as a receiver set; with all instances changed it computes everything from scratch.
    double frame(std::uint32_t index) {
        const std::vector<Placement> placements = layout_.placements(index);
        return bench::seconds_of([&] {
            scene_.set_transforms(ids_.size(), ids_.data(), &placements.front().transform[0][0],
                                  sizeof(Placement));
            if (set_.update(scene_.commit()).computed != layout_.receivers.size())
                throw std::runtime_error(layout_.name + ": a frame is not computed from scratch");
        });
    }
    std::vector<float> visibility() const {
        return {set_.visibility(), set_.visibility() + layout_.receivers.size()};
    }

    // One instance after the other is moved on by a frame.
    void move_ones(const paper::Lab& lab, InstancesRow& row) {
        frame(0);
        const std::vector<Placement> next = layout_.placements(1);
        std::vector<double> seconds;
        const auto moves = static_cast<std::size_t>(lab.rounds(kMoves));
        for (std::size_t i = 0; i < moves; ++i) {
            const std::size_t moved = (i * ids_.size() / moves + i) % ids_.size();
            dfield_update_stats stats{};
            seconds.push_back(bench::seconds_of([&] {
                scene_.set_transform(ids_[moved], &next[moved].transform[0][0]);
                stats = set_.update(scene_.commit());
            }));
            row.moved_receivers += static_cast<double>(stats.computed) / static_cast<double>(moves);
        }
        std::nth_element(seconds.begin(), seconds.begin() + seconds.size() / 2, seconds.end());
        row.moved_seconds = seconds[seconds.size() / 2];
        std::vector<float> queried(layout_.receivers.size());
        scene_.commit().visibility(ao_, layout_.receivers.view(), queried.data());
        if (std::memcmp(queried.data(), set_.visibility(), queried.size() * sizeof(float)) != 0)
            throw std::runtime_error(layout_.name + ": updates do not end with what a query of all gives");
    }

  private:
    const Layout& layout_;
    cli::ThreadedContext context_;
    std::vector<Field> fields_;
    Ao ao_;
    Scene scene_;
    std::vector<dfield_instance> ids_;
    ReceiverSet set_;
};

InstancesRow measure_layout(const paper::Lab& lab, const Layout& layout) {
    say_progress(layout.name);
    const Pairs pairs = shared_pairs(lab);
    std::vector<std::vector<std::byte>> fields;
    std::vector<std::unique_ptr<EmbreeScene>> objects;
    for (const paper::Model* model : layout.models) {
        fields.push_back(baked_specimen(model->mesh, layout.maps));
        objects.push_back(std::make_unique<EmbreeScene>(EmbreeUse::kFast));
        objects.back()->add_mesh(model->mesh);
        objects.back()->commit();
    }
    const std::vector<Placement> placements = layout.placements(0);
    EmbreeScene scene(EmbreeUse::kFast);
    for (const Placement& placement : placements)
        scene.add_instance(*objects[placement.object], placement.transform);
    scene.commit();

    InstancesRow row;
    row.layout = layout.name;
    row.maps = layout.maps.size;
    row.instances = placements.size();
    row.receivers = layout.receivers.size();
    row.frame_seconds = row.one_thread_seconds = row.two_threads_seconds =
        std::numeric_limits<double>::infinity();

    EmbreeContest embree(scene, layout.receivers, pairs, true);
    Crowd crowd(layout, fields, pairs, 1);
    for (int turn = 0; turn < lab.rounds(kEmbreeTurns); ++turn) {
        embree.turn();
        for (std::uint32_t frame = 0; frame < static_cast<std::uint32_t>(lab.rounds(kFrames)); ++frame)
            row.frame_seconds = std::min(row.frame_seconds, crowd.frame(frame));
    }
    row.embree_seconds = embree.seconds();
    row.embree_mode = embree.mode();
    row.rays = embree.rays();
    crowd.frame(0);
    row.rms = paper::errors_of(crowd.visibility(), embree.visibility()).rms;
    crowd.move_ones(lab, row);

    Crowd on_two(layout, fields, pairs, 2);
    for (int round = 0; round < lab.rounds(kThreadRounds); ++round) {
        row.one_thread_seconds = std::min(row.one_thread_seconds, crowd.frame(0));
        row.two_threads_seconds = std::min(row.two_threads_seconds, on_two.frame(0));
    }
    return row;
}

}  // namespace

void measure_instances(paper::Lab& lab, Report& report) {
    const auto pick = [&](const char* name, const char* own) {
        const paper::Model* model = lab.find(name);
        return model ? model : lab.find(own);
    };
    const paper::Model *bunny = pick("bunny", "cube with a hole"), *tree = pick("lemon tree", "leafy tree");
    const std::size_t divisor = lab.quick() ? 50 : 1;

    // The crowd's figure is an error and a speed, the swarm's a speed alone.
    Layout crowd_layout{{}, {}, direction_specimen(lab, 12, 64), {}, {}};
    const std::size_t crowd_count = lab.quick() ? 9 : 100;
    crowd_layout.name = bench::grouped(crowd_count) + " × " + bunny->name + ", rotated";
    crowd_layout.models = {bunny};
    crowd_layout.placements = [bounds = triangle_bounds(bunny->mesh), crowd_count](std::uint32_t frame) {
        return crowd(bounds, crowd_count, frame);
    };
    crowd_layout.receivers = ground(crowd_count, 100000 / divisor);
    const InstancesRow crowd_row = measure_layout(lab, crowd_layout);
    report.instances.push_back(crowd_row);

    Layout swarm_layout{{}, {}, direction_specimen(lab, 16, 32), {}, {}};
    const std::size_t swarm_count = lab.quick() ? 16 : 1000;
    swarm_layout.name = bench::grouped(swarm_count) + " × " + tree->name + " and " + bunny->name + ", moving";
    swarm_layout.models = {tree, bunny};
    swarm_layout.placements =
        [bounds = std::vector<Bounds>{triangle_bounds(tree->mesh), triangle_bounds(bunny->mesh)},
         swarm_count](std::uint32_t frame) { return swarm(bounds, swarm_count, frame); };
    swarm_layout.receivers = ground(swarm_count, 20000 / divisor);
    const InstancesRow swarm_row = measure_layout(lab, swarm_layout);
    report.instances.push_back(swarm_row);

    if (bunny->name != "bunny" || tree->name != "lemon tree") return;
    report.measured[Figure::kCrowdSpeedup] = crowd_row.speedup();
    report.measured[Figure::kCrowdError] = crowd_row.rms;
    report.measured[Figure::kTwoThreads] = crowd_row.one_thread_seconds / crowd_row.two_threads_seconds;
    report.measured[Figure::kSwarmSpeedup] = swarm_row.speedup();
    report.measured[Figure::kOneMoved] = 100 * swarm_row.moved_seconds / swarm_row.frame_seconds;
}

}  // namespace dfield::kinds
