#include "receiver_set.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <memory>
#include <new>
#include <utility>

#include "kind.hpp"
#include "octants/volume_visibility.hpp"
#include "receivers.hpp"
#include "status.hpp"

using namespace dfield::runtime;

dfield_receiver_set::dfield_receiver_set(dfield_context* context, const dfield_receiver_set_desc& desc)
    : Shared(context),
      visibility(context),
      changed(context),
      ao_(desc.ao),
      receivers_(context),
      chunks_(context),
      slabs_(context),
      reaches_(context),
      casters_before_(context),
      casters_now_(context),
      idle_(context) {
    const dfield_receivers& given = desc.receivers;
    const Strided<const float> positions(given.positions, given.position_stride, 3),
        normals(given.normals, given.normal_stride, 3),
        self(given.self_visibility, given.self_visibility_stride, 1);
    const Strided<const dfield_instance> owners(given.owners, given.owner_stride, 1),
        attached(desc.attached, desc.attached_stride, 1);
    receivers_.reserve(given.count);
    for (std::size_t i = 0; i < given.count; ++i)
        receivers_.push_back({positions.vec3(i), normals.vec3(i), owners ? *owners.at(i) : DFIELD_NO_INSTANCE,
                              attached ? *attached.at(i) : DFIELD_NO_INSTANCE, self ? *self.at(i) : 1.0f});
    for (const SetReceiver& receiver : receivers_) visibility.push_back(receiver.self_visibility);
    changed.reserve(given.count);
    arrange();
    ao_->retain();
}

dfield_receiver_set::~dfield_receiver_set() {
    for (UpdateScratch* scratch : idle_) std::pmr::polymorphic_allocator<>(context()).delete_object(scratch);
    if (last_) last_->release();
    ao_->release();
}

SceneChanges dfield_receiver_set::changes_to(const SceneState& now, bool batched) const {
    SceneChanges changes(context());
    const SceneState* const before = last_ ? &last_->scene.state : nullptr;
    const std::size_t old_count = before ? before->instances.size() : 0;
    changes.changed.resize(std::max(old_count, now.instances.size()));
    for (std::size_t id = 0; id < changes.changed.size(); ++id) {
        static const Instance kNone;
        const Instance& was = id < old_count ? before->instances[id] : kNone;
        const Instance& is = id < now.instances.size() ? now.instances[id] : kNone;
        if (was.revision == is.revision) continue;
        changes.changed[id] = true;
        ++changes.instances;
        if (was.field && !was.hidden) changes.before.push_back(static_cast<dfield_instance>(id));
        if (is.field && !is.hidden) changes.now.push_back(static_cast<dfield_instance>(id));
    }
    // Beyond this share of changed instances computing from scratch is less work (measured: an eighth to a
    // fifth).
    constexpr std::size_t kShare = 8;
    changes.all = !before || batched != batched_ || before->ground_revision != now.ground_revision ||
                  kShare * changes.before.size() > before->active.size() ||
                  kShare * changes.now.size() > now.active.size();
    return changes;
}

void dfield_receiver_set::find_casters(const SceneState* before, const SceneState& now,
                                       const SceneChanges& changes) {
    reaches_.resize(now.instances.size());
    for (const dfield_instance id : changes.all ? now.active : changes.now) {
        const DirectionCaster caster = direction_caster(*ao_, now.instances[id], id);
        reaches_[id] = {caster.centre, caster.reach};
    }
    casters_before_.clear();
    casters_now_.clear();
    if (!before) return;
    for (const dfield_instance id : changes.before)
        casters_before_.push_back(direction_caster(*ao_, before->instances[id], id));
    for (const dfield_instance id : changes.now)
        casters_now_.push_back(direction_caster(*ao_, now.instances[id], id));
}

UpdateScratch* dfield_receiver_set::take_scratch(std::size_t instances) {
    const std::lock_guard lock(scratch_mutex_);
    if (!idle_.empty()) {
        UpdateScratch* const scratch = idle_.back();
        scratch->candidates.reserve(instances);
        idle_.pop_back();
        return scratch;
    }
    idle_.reserve(scratch_count_ + 1);
    UpdateScratch* const scratch =
        std::pmr::polymorphic_allocator<>(context()).new_object<UpdateScratch>(context());
    idle_.push_back(scratch);
    ++scratch_count_;
    scratch->candidates.reserve(instances);
    idle_.pop_back();
    return scratch;
}

void dfield_receiver_set::give_scratch(UpdateScratch* scratch) {
    const std::lock_guard lock(scratch_mutex_);
    idle_.push_back(scratch);
}

void dfield_receiver_set::update(dfield_snapshot* snapshot, dfield_update_stats* stats) {
    const SceneState& now = snapshot->scene.state;
    require_kinds(*ao_, now, false);
    const bool batched = ao_->any_hit() && batch_share(now, *ao_) == BatchShare::kAll &&
                         volume_share(now, *ao_) == VolumeShare::kNone;
    const SceneChanges changes = changes_to(now, batched);
    if (batched) slabs_.resize(chunks_.size() * slab_count(ao_->shared));
    // From here on the old results are gone: should anything fail, the next update computes all.
    dfield_snapshot* const before = std::exchange(last_, nullptr);
    const auto release = [](dfield_snapshot* old) { dfield_snapshot_release(old); };
    const std::unique_ptr<dfield_snapshot, decltype(release)> keep(before, release);
    const SceneState* const old = changes.all ? nullptr : &before->scene.state;
    if (batched) find_casters(old, now, changes);
    place_attached(now, changes);
    std::atomic<bool> failed{false};
    context()->for_ranges(chunks_.size(), [&](std::size_t begin, std::size_t end) {
        UpdateScratch* scratch = nullptr;
        try {
            if (batched) scratch = take_scratch(now.active.size());
        } catch (const std::bad_alloc&) {
            failed = true;  // exceptions must not leave through the hook
            return;
        }
        for (std::size_t i = begin; i < end; ++i) {
            SetChunk& chunk = chunks_[i];
            chunk.computed.fill(0);
            chunk.changed.fill(0);
            if (batched && !changes.all)
                update_changed(i, now, changes, *scratch);
            else if (!batched)
                update_by_rays(chunk, old, now, changes);
        }
        if (batched && changes.all)
            for (std::size_t first = begin; first < end; first += UpdateScratch::kTogether)
                update_all(first, std::min(first + UpdateScratch::kTogether, end), now, *scratch);
        if (scratch) give_scratch(scratch);
    });
    casters_before_.clear();
    casters_now_.clear();
    if (failed) throw std::bad_alloc();
    snapshot->retain();
    last_ = snapshot;
    batched_ = batched;

    std::size_t computed = 0;
    changed.clear();
    for (const SetChunk& chunk : chunks_)
        for (std::size_t block = 0; block < chunk.chunk.blocks; ++block) {
            computed += static_cast<std::size_t>(std::popcount(chunk.computed[block]));
            for (std::uint32_t lanes = chunk.changed[block]; lanes != 0; lanes &= lanes - 1)
                changed.push_back(chunk.receiver[block * kLanes + std::countr_zero(lanes)]);
        }
    if (stats) *stats = {changes.instances, computed, changed.size()};
}
