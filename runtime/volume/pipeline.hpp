// Slabs that pass through stages: stage i of a slab follows stage i of the slab before and stage i - 1 of the
// same one. With the context's parallel loop, as many slabs are in flight as there are stages; without, a
// slab goes through all of them while it is in the cache. Both give the same results.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "context.hpp"

namespace dfield::runtime::volume {

template<std::size_t kStages>
class SlabPipeline {
  public:
    // parts: into how many independent parts each stage is split.
    SlabPipeline(const dfield_context* context, std::size_t slabs,
                 const std::array<std::size_t, kStages>& parts)
        : context_(context),
          slabs_(slabs),
          parts_(parts),
          parallel_(context->hooks.parallel_for != nullptr && slabs > 1) {}

    bool parallel() const { return parallel_; }
    // Slabs that need memory of their own; slab k may use that of k % ring().
    std::size_t ring() const { return parallel_ ? std::min(slabs_, kStages) : 1; }

    // Calls run(stage, slab, part).
    template<class Run>
    void run(const Run& run) const {
        if (!parallel_) {
            for (std::size_t slab = 0; slab < slabs_; ++slab)
                for (std::size_t stage = 0; stage < kStages; ++stage)
                    for (std::size_t part = 0; part < parts_[stage]; ++part) run(stage, slab, part);
            return;
        }
        struct Task {
            std::size_t stage, part;
        };
        std::array<Task, 4 * kStages> tasks;
        std::size_t count = 0;
        for (const bool whole : {true, false})  // the long ones first
            for (std::size_t stage = 0; stage < kStages; ++stage)
                if ((parts_[stage] == 1) == whole)
                    for (std::size_t part = 0; part < parts_[stage]; ++part) tasks[count++] = {stage, part};
        for (std::size_t step = 0; step < slabs_ + kStages - 1; ++step)
            context_->for_ranges(count, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    if (step >= tasks[i].stage && step - tasks[i].stage < slabs_)
                        run(tasks[i].stage, step - tasks[i].stage, tasks[i].part);
            });
    }

  private:
    const dfield_context* context_;
    std::size_t slabs_;
    std::array<std::size_t, kStages> parts_;
    bool parallel_;
};

}  // namespace dfield::runtime::volume
