// What a session's changes do to its volume: another transfer function, clips that come, move and go.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "volume/contextual.hpp"
#include "volume/local_setup.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

namespace {

// What is left of a block's row of voxels, and what was; beyond the grid all, so that loops are of one
// length.
struct BlockRow {
    std::array<std::uint8_t, kBlockX> now, before;

    BlockRow(const std::uint8_t* row_now, const std::uint8_t* row_before, std::size_t count,
             std::uint8_t all) {
        if (count < kBlockX) {
            now.fill(all);
            before.fill(all);
        }
        std::memcpy(now.data(), row_now, count);
        std::memcpy(before.data(), row_before, count);
    }
    bool same() const { return now == before; }
    bool is(std::uint8_t value) const {
        bool is = true;
        for (const std::uint8_t n : now) is &= n == value;
        return is;
    }
    // Adds the voxels' flags to `states`; how many changed their opacity or whether they are clipped.
    std::uint64_t changes(const float* opacity, std::uint8_t all,
                          std::array<std::uint8_t, kBlockX>& states) const {
        // Bytes of 0 and 1, and no branches: loops that are vectorised.
        std::array<std::uint8_t, kBlockX> matter, counted;
        for (std::size_t i = 0; i < kBlockX; ++i) matter[i] = opacity[i] != 0;
        for (std::size_t i = 0; i < kBlockX; ++i) {
            const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
            const std::uint8_t gone = byte(now[i] == 0), turned = byte(gone ^ (before[i] == 0)),
                               other = byte(matter[i] & (now[i] != before[i])),
                               differs = byte(matter[i] & (now[i] != all));
            counted[i] = turned | other;
            states[i] |= byte(differs * kDiffers | other * kChanged | turned * kTurned | gone * kGone);
        }
        std::uint64_t count = 0;
        for (const std::uint8_t one : counted) count += one;
        return count;
    }
};

}  // namespace

// The volume through another transfer function, nothing clipped; which blocks' factors change for it.
void dfield_contextual::change_opacity() {
    const bool first = !filled_;
    const OpacityFunction& next = next_opacity_ ? *next_opacity_ : opacity_;
    std::atomic<bool> finite{true};
    // Rows of bricks, so that no two threads share a flag.
    context()->for_ranges(flags_.nz(), [&](std::size_t begin, std::size_t end) {
        constexpr std::size_t kPiece = 32 * kBrickX;
        float before[kPiece];
        for (std::size_t z = begin * kBrickZ; z < std::min(end * kBrickZ, grid_.nz); ++z)
            for (std::size_t y = 0; y < grid_.ny; ++y) {
                const std::byte* const samples = samples_.row(y, z);
                float* const now = volume_.row(y, z);
                if (!next.row(samples, 0, grid_.nx, now)) finite.store(false, std::memory_order_relaxed);
                std::uint8_t* const flags = flags_.brick(0, y / kBrickY, z / kBrickZ);
                for (std::size_t x = 0; !first && x < grid_.nx; x += kPiece) {
                    const std::size_t count = std::min(kPiece, grid_.nx - x);
                    (void)opacity_.row(samples, x, x + count, before);  // finite, as it was the last time
                    for (std::size_t i = 0; i < count; ++i)
                        if (before[i] != now[x + i]) flags[(x + i) / kBrickX] |= kChanged;
                }
            }
    });
    clipped_ = filled_ = box_filled_ = false;
    require_finite(finite.load(std::memory_order_relaxed));
    const Box all{{0, 0, 0}, {grid_.nx, grid_.ny, grid_.nz}};
    volume_.update_occupied(context(), all.low.data(), all.high.data());
    if (first) {
        std::fill(pending_unclipped_.begin(), pending_unclipped_.end(), ~0u);
        std::fill(pending_.begin(), pending_.end(), ~0u);
    } else {
        flags_.update_windows();
        mark_affected(pending_unclipped_);
        for (std::size_t i = 0; i < pending_.size(); ++i) pending_[i] |= pending_unclipped_[i];
        flags_.clear(kChanged);
    }
    for (std::size_t i = 0; i < pending_.size(); ++i) saved_[i] &= ~pending_unclipped_[i];
    if (next_opacity_) {
        opacity_ = std::move(*next_opacity_);
        next_opacity_.reset();
    }
    filled_ = true;
}

// A block of the clipped volume: what is left of its voxels, their opacities, and the flags of its bricks.
bool dfield_contextual::change_block(std::span<const PlacedClip> clips, std::size_t x, std::size_t y,
                                     std::size_t z, bool retest, std::uint64_t& changed) {
    const std::uint8_t all = coverage_.all();
    std::uint8_t left[kBlock];
    const std::size_t nx = std::min(kBlockX, grid_.nx - x), ny = std::min(kBlockY, grid_.ny - y),
                      nz = std::min(kBlockZ, grid_.nz - z);
    const auto for_rows = [&](const auto& use) {
        for (std::size_t k = 0; k < nz; ++k)
            for (std::size_t j = 0; j < ny; ++j)
                use(left + (k * kBlockY + j) * kBlockX,
                    left_ + static_cast<std::ptrdiff_t>(grid_.index(x, y + j, z + k)), y + j, z + k);
    };
    if (!retest)
        for_rows(
            [&](std::uint8_t* now, const std::uint8_t* before, auto, auto) { std::copy_n(before, nx, now); });
    else if (!coverage_.of_block(clips, x, y, z, left))
        std::fill_n(left, kBlock, all);
    bool same = true, full = true;
    for_rows([&](const std::uint8_t* now, const std::uint8_t* before, auto, auto) {
        const BlockRow row(now, before, nx, all);
        same = same && row.same();
        full = full && row.is(all);
    });
    // The opacities are those of what was left before, or of nothing clipped.
    if (same && (clipped_ || full)) return false;
    // All lookups before any is used: what was stored one by one cannot be loaded together at once.
    std::array<float, kBlock> opacities{};
    for_rows([&](const std::uint8_t* now, auto, std::size_t row_y, std::size_t row_z) {
        (void)opacity_.row(samples_.row(row_y, row_z), x, x + nx,  // finite, as all of the volume
                           opacities.data() + (now - left));
    });
    std::array<std::uint8_t, kBlockX> states{}, occupied{};
    for_rows([&](const std::uint8_t* now, std::uint8_t* before, std::size_t row_y, std::size_t row_z) {
        float* const opacity = opacities.data() + (now - left);
        const BlockRow row(now, before, nx, all);
        changed += row.changes(opacity, all, states);
        if (row.is(0))
            std::fill_n(opacity, kBlockX, 0.0f);
        else if (!row.is(all))
            for (std::size_t i = 0; i < nx; ++i) opacity[i] *= coverage_.share(now[i]);
        for (std::size_t i = 0; i < kBlockX; ++i) occupied[i] |= opacity[i] != 0;
        std::copy_n(opacity, nx, volume_.row(row_y, row_z) + x);
        std::copy_n(now, nx, before);
    });
    std::uint8_t *const flags = flags_.brick(x / kBrickX, y / kBrickY, z / kBrickZ),
                        *const matter = volume_.occupied().brick(x / kBrickX, y / kBrickY, z / kBrickZ);
    for (std::size_t i = 0; i < (nx + kBrickX - 1) / kBrickX; ++i) {
        const auto of_brick = [&](const auto& of_voxels) {
            std::uint8_t any = 0;
            for (std::size_t j = 0; j < kBrickX; ++j) any |= of_voxels[i * kBrickX + j];
            return any;
        };
        flags[i] = static_cast<std::uint8_t>((flags[i] & (kChanged | kTurned)) | of_brick(states));
        matter[i] = of_brick(occupied);
    }
    return true;
}

dfield_contextual::Region dfield_contextual::change_clips() {
    Region region;
    const Box all{{0, 0, 0}, {grid_.nx, grid_.ny, grid_.nz}};
    applied_.clear();
    for (const Clip& clip : clips_)
        if (!clip.removed) applied_.emplace_back(clip.given, grid_);
    Box retest;
    std::size_t placed = 0;
    for (Clip& clip : clips_) {
        const Box now = clip.removed ? Box{} : bounds(applied_[placed++]);
        if (clip.changed || clip.removed) {
            if (clip.applied) retest.include(*clip.applied);
            retest.include(now);
            // All that is outside a probe comes and goes with it.
            if (clip.given.mode == DFIELD_CLIP_PROBE && (!clip.applied || clip.removed)) retest.include(all);
        }
        if (!clip.removed) clip.applied = now;
        clip.changed = false;
    }
    std::erase_if(clips_, [](const Clip& clip) {
        if (clip.removed) const_cast<dfield_clip_mesh*>(clip.given.mesh)->release();
        return clip.removed;
    });
    const Box work = clipped_ ? retest : all;
    if (work.empty()) return region;
    const std::size_t block[3] = {kBlockX, kBlockY, kBlockZ};
    std::size_t first[3], count[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = work.low[axis] / block[axis];
        count[axis] = (work.high[axis] + block[axis] - 1) / block[axis] - first[axis];
    }
    std::atomic<std::uint64_t> changed{0};
    context()->for_ranges(count[1] * count[2], [&](std::size_t begin, std::size_t end) {
        std::uint64_t here = 0;
        for (std::size_t row = begin; row < end; ++row) {
            const std::size_t y = (first[1] + row % count[1]) * kBlockY,
                              z = (first[2] + row / count[1]) * kBlockZ;
            for (std::size_t i = 0; i < count[0]; ++i) {
                const std::size_t x = (first[0] + i) * kBlockX;
                const bool inside = x < retest.high[0] && x + kBlockX > retest.low[0] && y < retest.high[1] &&
                                    y + kBlockY > retest.low[1] && z < retest.high[2] &&
                                    z + kBlockZ > retest.low[2];
                change_block(applied_, x, y, z, inside, here);
            }
        }
        changed.fetch_add(here, std::memory_order_relaxed);
    });
    clipped_ = true;
    region.voxels = work;
    region.changed = changed.load(std::memory_order_relaxed);
    refresh_windows(work);
    return region;
}

void dfield_contextual::refresh_windows(const Box& voxels) const {
    const std::size_t brick[3] = {kBrickX, kBrickY, kBrickZ},
                      all[3] = {flags_.nx(), flags_.ny(), flags_.nz()};
    std::size_t low[3], high[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // Whole blocks were changed.
        const std::size_t block[3] = {kBlockX, kBlockY, kBlockZ};
        low[axis] = voxels.low[axis] / block[axis] * (block[axis] / brick[axis]);
        high[axis] = std::min(
            all[axis], (voxels.high[axis] + block[axis] - 1) / block[axis] * (block[axis] / brick[axis]));
    }
    for (const BrickFlags* flags : {&flags_, &volume_.occupied()}) flags->update_windows(low, high);
}
