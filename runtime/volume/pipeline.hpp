// Slabs that pass through stages, each some steps long. A worker takes a slab through all of them while it is
// in its cache; several workers follow one another, each a step behind the one with the slab before. The
// results are the same at any number of workers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "context.hpp"

namespace dfield::runtime::volume {

struct SlabStage {
    std::size_t steps;
    bool follows;  // whether step i waits for step i of this stage of the slab before
};

constexpr std::size_t kMostWorkers = 8;  // each has scratch memory for a slab

template<std::size_t kStages>
class SlabPipeline {
  public:
    SlabPipeline(const dfield_context* context, std::size_t slabs,
                 const std::array<SlabStage, kStages>& stages)
        : context_(context),
          slabs_(slabs),
          stages_(stages),
          workers_(context->hooks.parallel_for ? std::min(slabs, kMostWorkers) : 1) {
        for (const SlabStage& stage : stages) total_ += stage.steps;
    }

    // How many there may be. Each has one slab at a time, and slabs begin in order; if the last stage
    // follows, slab k ends before slab k + workers() begins.
    std::size_t workers() const { return workers_; }

    // Calls run(worker, slab, stage, step).
    template<class Run>
    void run(const Run& run) const {
        if (workers_ == 1) {
            for (std::size_t slab = 0; slab < slabs_; ++slab)
                for (std::size_t stage = 0; stage < kStages; ++stage)
                    for (std::size_t step = 0; step < stages_[stage].steps; ++step)
                        run(std::size_t{0}, slab, stage, step);
            return;
        }
        Progress progress;
        std::atomic<std::size_t> next{0};
        // The caller's loop decides how many of these run at once. A slab waits only for one that a running
        // worker has taken before, so one alone would get through, and any order of starting them is good.
        context_->for_ranges(workers_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t worker = begin; worker < end; ++worker)
                for (std::size_t slab; (slab = next.fetch_add(1, std::memory_order_relaxed)) < slabs_;)
                    pass(run, worker, slab, progress);
        });
    }

  private:
    // How far slabs have come: after step `at` of slab k, entry k modulo their number is k total_ + at + 1.
    // While steps of slab k have to wait, slabs up to k + workers() - 1 at most have begun, so the entry of
    // k - 1 is still its own; and what it may become later is larger.
    struct alignas(64) Entry {
        std::atomic<std::uint64_t> value{0};
    };
    using Progress = std::array<Entry, kMostWorkers + 1>;

    template<class Run>
    void pass(const Run& run, std::size_t worker, std::size_t slab, Progress& progress) const {
        std::uint64_t at = slab * total_;
        const auto& before = progress[(slab + kMostWorkers) % (kMostWorkers + 1)].value;
        auto& own = progress[slab % (kMostWorkers + 1)].value;
        for (std::size_t stage = 0; stage < kStages; ++stage)
            for (std::size_t step = 0; step < stages_[stage].steps; ++step, ++at) {
                const bool follows = stages_[stage].follows;
                if (follows && slab > 0) wait_until(before, at - total_ + 1);
                run(worker, slab, stage, step);
                if (follows) own.store(at + 1, std::memory_order_release);
            }
    }

    static void wait_until(const std::atomic<std::uint64_t>& value, std::uint64_t least) {
        constexpr int kPatience = 1000;  // loads, before somebody else may need the processor
        for (int i = 0; value.load(std::memory_order_acquire) < least; ++i)
            if (i >= kPatience) std::this_thread::yield();
    }

    const dfield_context* context_;
    std::size_t slabs_;
    std::array<SlabStage, kStages> stages_;
    std::size_t workers_, total_ = 0;
};

}  // namespace dfield::runtime::volume
