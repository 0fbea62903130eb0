#include "volume/contextual.hpp"

#include <algorithm>
#include <atomic>

#include "volume/local_setup.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

namespace dfield::runtime::volume {

void Box::include(const Box& other) {
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], other.low[axis]);
        high[axis] = std::max(high[axis], other.high[axis]);
    }
}

namespace {

// The six axes: what a voxel is roughly.
dfield_local_desc rough(dfield_local_desc desc) {
    desc.ray_set = DFIELD_RAYS_NEIGHBOURS;
    desc.ray_count = 6;
    desc.weights = nullptr;
    desc.jitter = 0;
    return desc;
}

Offset lowest(const LocalRays& rays, const LocalRays& rough) {
    Offset low;
    for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = std::min({rays.low[axis], rough.low[axis], -1});
    return low;
}
Offset highest(const LocalRays& rays, const LocalRays& rough) {
    Offset high;
    for (std::size_t axis = 0; axis < 3; ++axis)
        high[axis] = std::max({rays.high[axis], rough.high[axis], 1});
    return high;
}

// Where the samples of a block's voxels are read, that is where a change matters to it.
std::pmr::vector<Offset> offsets_of(std::pmr::memory_resource* memory, const LocalRays& rays) {
    std::pmr::vector<Offset> offsets(memory);
    if (rays.jitter.most == 0) {
        for (const RayStep& step : rays.steps) offsets.push_back(step.offset);
        return offsets;
    }
    // Anywhere in the box.
    for (std::int32_t z = rays.low[2]; z <= rays.high[2]; z += kBrickZ)
        for (std::int32_t y = rays.low[1]; y <= rays.high[1]; y += kBrickY)
            for (std::int32_t x = rays.low[0]; x <= rays.high[0]; x += kBrickX) offsets.push_back({x, y, z});
    return offsets;
}

constexpr std::array<Offset, 8> kNeighbours{
    {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}}};

}  // namespace
}  // namespace dfield::runtime::volume

dfield_contextual::dfield_contextual(dfield_context* context, const dfield_contextual_desc& desc)
    : Shared(context),
      grid_(checked_grid(checked_volume(&desc.samples).grid)),
      samples_(checked_samples(desc.samples, grid_)),
      local_(checked_local(&desc.local)),
      dilated_mode_(desc.mask == DFIELD_UPDATE_DILATED),
      rays_(rays_of(context, grid_, local_)),
      rough_rays_(rays_of(context, grid_, rough(local_))),
      coverage_(context, desc.clip_samples),
      opacity_(opacity_of(context, &desc.opacity, local_, grid_, samples_.type)),
      volume_(context, grid_, lowest(rays_, rough_rays_), highest(rays_, rough_rays_)),
      plan_(context, rays_, volume_),
      rough_plan_(context, rough_rays_, volume_),
      exchange_(dilated_mode_ ? nullptr : exchange_function(*context, rays_)),
      flags_(context, grid_, lowest(rays_, rough_rays_), highest(rays_, rough_rays_)),
      rays_reach_(context, flags_, offsets_of(context, rays_)),
      neighbours_reach_(context, flags_, kNeighbours),
      left_(context, grid_.size(), coverage_.all()),
      visibility_(context, grid_.size(), 1.0f),
      tiles_(tiles_of(grid_)),
      unclipped_(context, tile_count(grid_)),
      pending_unclipped_(tile_count(grid_), 0u, context),
      pending_(pending_unclipped_.size(), 0u, context),
      pending_rough_(pending_unclipped_.size(), 0u, context),
      apart_(pending_unclipped_.size(), 0u, context),
      affected_(pending_unclipped_.size(), 0u, context),
      saved_(pending_unclipped_.size(), 0u, context),
      order_(context),
      clips_(context),
      applied_(context),
      dilations_(context) {
    order_.reserve(pending_.size());
}

dfield_contextual::~dfield_contextual() {
    for (const Clip& clip : clips_) const_cast<dfield_clip_mesh*>(clip.given.mesh)->release();
}

dfield_contextual::Clip& dfield_contextual::find(std::uint32_t id) {
    for (Clip& clip : clips_)
        if (clip.id == id && !clip.removed) return clip;
    throw Failure{DFIELD_INVALID_ARGUMENT, "dfield_contextual: there is no clip of this id"};
}

std::uint32_t dfield_contextual::add(const dfield_clip& clip) {
    const PlacedClip checked(clip, grid_);
    applied_.reserve(clips_.size() + 1);
    clips_.push_back({next_id_, clip, true, false, {}});
    const_cast<dfield_clip_mesh*>(clip.mesh)->retain();
    return next_id_++;
}

void dfield_contextual::move(std::uint32_t id, const float* mesh_to_world) {
    Clip& clip = find(id);
    dfield_clip moved = clip.given;
    std::copy_n(mesh_to_world, 16, moved.mesh_to_world);
    const PlacedClip checked(moved, grid_);
    clip.given = moved;
    clip.changed = true;
}

void dfield_contextual::remove(std::uint32_t id) {
    find(id).removed = true;
}

void dfield_contextual::set_opacity(const dfield_opacity_desc& opacity) {
    next_opacity_.emplace(opacity_of(context(), &opacity, local_, grid_, samples_.type));
}

Box dfield_contextual::bounds(const PlacedClip& clip) const {
    Box box;
    clip.bounds(grid_, box.low.data(), box.high.data());
    return box;
}

Tile dfield_contextual::tile(std::size_t index) const {
    Tile tile = tile_at(grid_, index);
    tile.blocks = 0;
    return tile;
}

template<class Wanted, class Use>
bool dfield_contextual::for_tiles(const Deadline& deadline, const Wanted& wanted, const Use& use) {
    order_.clear();
    for (std::uint32_t i = 0; i < pending_.size(); ++i)
        if (wanted(i)) order_.push_back(i);
    // Batches small enough to end in time, large enough for some threads.
    const std::size_t batch = !deadline.can_end()             ? order_.size()
                              : context()->hooks.parallel_for ? std::size_t{16}
                                                              : std::size_t{1};
    for (std::size_t done = 0; done < order_.size(); done += batch) {
        if (deadline.can_end() && deadline.over()) return false;
        context()->for_ranges(std::min(batch, order_.size() - done), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) use(order_[done + i]);
        });
    }
    return true;
}

void dfield_contextual::mark_affected(std::pmr::vector<std::uint32_t>& pending) const {
    rays_reach_.mark(context(), grid_, flags_, kChanged, pending);
    neighbours_reach_.mark(context(), grid_, flags_, kTurned, pending);
}

void dfield_contextual::mark_dilated(dfield_update_result& result) {
    std::pmr::vector<Dilation> known(std::move(dilations_));  // those that no clip needs any more end here
    dilations_.clear();
    std::pmr::vector<std::size_t> which(context());
    for (const PlacedClip& clip : applied_) {
        const double radius = dilation_radius(clip, grid_, rays_.reach, coverage_.all() > 1);
        // Turned and moved, a mesh keeps its maps; made smaller or larger it needs others.
        const auto suits = [&](const Dilation& d) {
            return d.mesh() == clip.mesh && d.probe() == clip.probe && d.radius() >= radius &&
                   d.radius() <= 1.0001 * radius;
        };
        auto found = std::ranges::find_if(dilations_, suits);
        if (found == dilations_.end()) {
            if (const auto kept = std::ranges::find_if(known, suits); kept != known.end())
                dilations_.push_back(std::move(*kept)), known.erase(kept);
            else
                dilations_.emplace_back(context(), *clip.mesh, clip.probe, 1.00005 * radius);
            found = std::prev(dilations_.end());
        }
        which.push_back(static_cast<std::size_t>(found - dilations_.begin()));
    }
    std::atomic<std::uint64_t> masked{0};
    context()->for_ranges(pending_.size(), [&](std::size_t begin, std::size_t end) {
        std::uint64_t here = 0;
        for (std::size_t index = begin; index < end; ++index) {
            Tile t = tile(index);
            t.blocks = ~0u;
            std::uint32_t now = 0;
            for_blocks(grid_, t, [&](std::size_t bit, std::size_t x, std::size_t y, std::size_t z) {
                std::uint64_t voxels = 0;
                const bool gone = block_is_gone(grid_, left_.get(), x, y, z);
                for (std::size_t k = z; !gone && k < std::min(z + kBlockZ, grid_.nz); ++k)
                    for (std::size_t j = y; j < std::min(y + kBlockY, grid_.ny); ++j)
                        for (std::size_t i = x; i < std::min(x + kBlockX, grid_.nx); ++i) {
                            bool affected = false;
                            for (std::size_t c = 0; c < applied_.size() && !affected; ++c)
                                affected = dilations_[which[c]].affected(applied_[c].to_camera(
                                    static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)));
                            if (!affected) continue;
                            now |= 1u << bit;
                            voxels += left_.get()[grid_.index(i, j, k)] > 0;
                        }
                here += voxels;
            });
            pending_[index] |= now | apart_[index];
            apart_[index] = now;
        }
        masked.fetch_add(here, std::memory_order_relaxed);
    });
    result.masked = masked.load(std::memory_order_relaxed);
}

// Whether a block has voxels that are gone.
bool dfield_contextual::has_gone(std::size_t x, std::size_t y, std::size_t z) const {
    const std::uint8_t* const bricks = flags_.brick(x / kBrickX, y / kBrickY, z / kBrickZ);
    std::uint8_t flags = 0;
    for (std::size_t i = 0; i < kBlockX / kBrickX; ++i) flags |= bricks[i];  // beyond the grid there are none
    return flags & kGone;
}

// Of pending blocks: which are affected by clips; and room for what these are unclipped.
void dfield_contextual::make_room() {
    std::pmr::vector<std::uint32_t> apart(context());
    if (!dilated_mode_) {
        apart.assign(pending_.size(), 0u);
        rays_reach_.mark(context(), grid_, flags_, kDiffers, apart);
    }
    context()->for_ranges(pending_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t index = begin; index < end; ++index) {
            if (pending_[index] == 0) continue;
            Tile t = tile(index);
            t.blocks = pending_[index];
            std::uint32_t gone = 0;
            for_blocks(grid_, t, [&](std::size_t bit, std::size_t x, std::size_t y, std::size_t z) {
                if (has_gone(x, y, z)) gone |= 1u << bit;
            });
            if (!dilated_mode_) apart_[index] = (apart_[index] & ~t.blocks) | (apart[index] & t.blocks);
            affected_[index] = (affected_[index] & ~t.blocks) | ((apart_[index] | gone) & t.blocks);
        }
    });
    drop_unclipped();
    for (std::size_t index = 0; index < pending_.size(); ++index) unclipped_.add(index, affected_[index]);
}

// Unclipped factors that visibility_ has.
void dfield_contextual::drop_unclipped() {
    for (std::size_t index = 0; index < pending_.size(); ++index)
        unclipped_.keep(index, affected_[index] | saved_[index]);
    unclipped_.trim();
}

// The pending blocks of a tile: along all rays where the clipped volume matters to them, otherwise as they
// are unclipped.
void dfield_contextual::compute(const Tile& wanted, LocalFunction* local, const LocalPlan& plan,
                                std::uint64_t& voxels) {
    Tile rays = wanted;
    rays.blocks = 0;
    std::uint32_t some_gone = 0, all_gone = 0;
    const std::size_t index =
        wanted.x / kTileX + tiles_[0] * (wanted.y / kTileY + tiles_[1] * (wanted.z / kTileZ));
    std::array<const float*, 32> unclipped{};
    for_blocks(grid_, wanted, [&](std::size_t bit, std::size_t x, std::size_t y, std::size_t z) {
        const std::uint32_t block = 1u << bit;
        const std::size_t nx = std::min(kBlockX, grid_.nx - x), ny = std::min(kBlockY, grid_.ny - y),
                          nz = std::min(kBlockZ, grid_.nz - z);
        float* const saved = unclipped_.at(index, bit);
        const auto for_rows = [&](const auto& use) {
            for (std::size_t k = 0; k < nz; ++k)
                for (std::size_t j = 0; j < ny; ++j)
                    use(saved + (k * kBlockY + j) * kBlockX,
                        visibility_ + static_cast<std::ptrdiff_t>(grid_.index(x, y + j, z + k)));
        };
        if ((affected_[index] & block) && !(saved_[index] & block)) {
            for_rows([&](float* kept, const float* row) { std::copy_n(row, nx, kept); });
            saved_[index] |= block;
        }
        unclipped[bit] = saved;
        if (has_gone(x, y, z)) {
            some_gone |= block;
            if (block_is_gone(grid_, left_.get(), x, y, z)) {
                all_gone |= block;
                for_rows([&](const float*, float* row) { std::fill_n(row, nx, 1.0f); });
                return;
            }
        }
        if (apart_[index] & block) {
            rays.blocks |= block;
            voxels += nx * ny * nz;
        } else if (saved_[index] & block) {
            for_rows([&](const float* kept, float* row) { std::copy_n(kept, nx, row); });
            saved_[index] &= ~block | affected_[index];
        }
    });
    if (rays.blocks != 0 && exchange_ && &plan == &plan_)
        rays.blocks = exchange_({&volume_, &box_, &flags_, &plan, unclipped.data(), visibility_.get()}, rays);
    if (rays.blocks != 0) local({&volume_, &plan, visibility_.get()}, rays);
    Tile mixed = wanted;
    mixed.blocks = some_gone & ~all_gone;
    for_blocks(grid_, mixed, [&](auto, std::size_t x, std::size_t y, std::size_t z) {
        open_gone_voxels(grid_, left_.get(), x, y, z, visibility_.get());
    });
}

void dfield_contextual::update(const dfield_update_desc& desc, dfield_update_result& result) {
    const Deadline deadline(desc);
    result = {};
    LocalFunction* const local = local_function(*context(), rays_);
    LocalFunction* const local_rough = local_function(context()->simd_targets);
    Box touched;
    const auto touch = [&](std::uint32_t index, std::uint32_t blocks) {
        if (blocks == 0) return;
        const Tile t = tile(index);
        touched.include({{t.x, t.y, t.z},
                         {std::min(grid_.nx, t.x + kTileX), std::min(grid_.ny, t.y + kTileY),
                          std::min(grid_.nz, t.z + kTileZ)}});
    };
    const auto end = [&](bool final) {
        result.is_final = final ? 1 : 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            result.low[axis] = static_cast<std::uint32_t>(touched.low[axis]);
            result.high[axis] = static_cast<std::uint32_t>(touched.high[axis]);
        }
        result.seconds = deadline.seconds();
    };

    if (next_opacity_ || !filled_) {
        change_opacity();
        std::copy(pending_unclipped_.begin(), pending_unclipped_.end(), pending_rough_.begin());
    }
    if (std::any_of(pending_unclipped_.begin(), pending_unclipped_.end(),
                    [](std::uint32_t b) { return b; })) {
        for (std::uint32_t i = 0; i < pending_.size(); ++i) touch(i, pending_unclipped_[i]);
        bool done = true;
        if (deadline.is_set())
            done = for_tiles(
                deadline, [&](std::uint32_t i) { return pending_rough_[i] != 0; },
                [&](std::uint32_t i) {
                    Tile t = tile(i);
                    t.blocks = std::exchange(pending_rough_[i], 0u);
                    local_rough({&volume_, &rough_plan_, visibility_.get()}, t);
                });
        done = done && for_tiles(
                           deadline, [&](std::uint32_t i) { return pending_unclipped_[i] != 0; },
                           [&](std::uint32_t i) {
                               Tile t = tile(i);
                               t.blocks = std::exchange(pending_unclipped_[i], 0u);
                               local({&volume_, &plan_, visibility_.get()}, t);
                           });
        if (!done) return end(false);
    }
    const double before_clips = deadline.seconds();
    const bool clips_changed = std::any_of(clips_.begin(), clips_.end(),
                                           [](const Clip& clip) { return clip.changed || clip.removed; });
    if (clips_changed || !clipped_) {
        try {
            const Region region = change_clips();
            result.changed = region.changed;
            if (!region.voxels.empty()) mark_affected(pending_);
            if (dilated_mode_) mark_dilated(result);
            make_room();
            if (exchange_) {
                box_.cover(context(), volume_, flags_, kDiffers, samples_, opacity_, box_filled_);
                box_filled_ = true;
            }
        } catch (...) {  // without memory: what is affected is not known, so the next update computes all
            clipped_ = false;
            std::fill(pending_.begin(), pending_.end(), ~0u);
            dilations_.clear();  // of meshes that may be gone
            throw;
        }
        std::copy(pending_.begin(), pending_.end(), pending_rough_.begin());
        flags_.clear(kChanged | kTurned);
    }
    result.clip_seconds = deadline.seconds() - before_clips;

    std::atomic<std::uint64_t> voxels{0};
    const auto compute_all = [&](std::pmr::vector<std::uint32_t>& pending, LocalFunction* function,
                                 const LocalPlan& plan, bool count) {
        return for_tiles(
            deadline, [&](std::uint32_t i) { return pending[i] != 0; },
            [&](std::uint32_t i) {
                Tile t = tile(i);
                t.blocks = std::exchange(pending[i], 0u);
                pending_rough_[i] = 0;
                std::uint64_t here = 0;
                compute(t, function, plan, here);
                if (count) voxels.fetch_add(here, std::memory_order_relaxed);
            });
    };
    for (std::uint32_t i = 0; i < pending_.size(); ++i) touch(i, pending_[i]);
    if (deadline.is_set()) compute_all(pending_rough_, local_rough, rough_plan_, false);
    const bool done = compute_all(pending_, local, plan_, true);
    drop_unclipped();
    result.recomputed = voxels.load(std::memory_order_relaxed);
    end(done);
}
