// A session of contextual ambient occlusion: what is known of the volume from frame to frame, and which
// blocks of it are to be computed anew.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <vector>

#include "context.hpp"
#include "volume/block_store.hpp"
#include "volume/buffer.hpp"
#include "volume/clip_coverage.hpp"
#include "volume/clip_dilation.hpp"
#include "volume/local.hpp"
#include "volume/stencil.hpp"

namespace dfield::runtime::volume {

// Voxels [low, high).
struct Box {
    std::array<std::size_t, 3> low{}, high{};

    bool empty() const { return low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]; }
    void include(const Box& other);
};

// When an update has to end.
class Deadline {
  public:
    explicit Deadline(const dfield_update_desc& desc) : desc_(desc) {}

    bool is_set() const { return desc_.seconds > 0; }
    bool can_end() const { return is_set() || desc_.cancelled; }
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    bool over() const {
        return (is_set() && seconds() >= desc_.seconds) || (desc_.cancelled && desc_.cancelled(desc_.user));
    }

  private:
    const dfield_update_desc desc_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Sets what voxels are that nothing is left of and that have no neighbour of which anything is: 1. `left` is
// Coverage's byte of every voxel, packed. True where the whole block is such.
bool block_is_gone(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z);
void open_gone_voxels(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z,
                      float* visibility);

}  // namespace dfield::runtime::volume

struct dfield_contextual final : dfield::runtime::Shared<dfield_contextual> {
    dfield_contextual(dfield_context* context, const dfield_contextual_desc& desc);
    ~dfield_contextual();

    std::uint32_t add(const dfield_clip& clip);
    void move(std::uint32_t id, const float* mesh_to_world);
    void remove(std::uint32_t id);
    void set_opacity(const dfield_opacity_desc& opacity);
    void update(const dfield_update_desc& desc, dfield_update_result& result);

    const float* visibility() const { return visibility_.get(); }
    const std::uint8_t* left() const { return left_.get(); }
    const dfield::runtime::volume::Grid& grid() const { return grid_; }
    std::span<const dfield::runtime::volume::PlacedClip> applied() const { return applied_; }

  private:
    using Grid = dfield::runtime::volume::Grid;
    using Box = dfield::runtime::volume::Box;
    using Tile = dfield::runtime::volume::Tile;
    using PlacedClip = dfield::runtime::volume::PlacedClip;

    struct Clip {
        std::uint32_t id;
        dfield_clip given;  // keeps its mesh alive
        bool changed, removed;
        std::optional<Box> applied;  // where it may clip since the last update
    };
    struct Region {
        Box voxels;
        std::uint64_t changed = 0;
    };

    Clip& find(std::uint32_t id);
    Box bounds(const PlacedClip& clip) const;
    Tile tile(std::size_t index) const;
    // Calls use(index) for all tiles, on any threads; in batches, until the deadline, if there is one. True
    // when done.
    template<class Wanted, class Use>
    bool for_tiles(const dfield::runtime::volume::Deadline& deadline, const Wanted& wanted, const Use& use);
    void change_opacity();
    Region change_clips();
    bool change_block(std::span<const PlacedClip> clips, std::size_t x, std::size_t y, std::size_t z,
                      bool retest, std::uint64_t& changed);
    void mark_affected(std::pmr::vector<std::uint32_t>& pending) const;
    void mark_dilated(dfield_update_result& result);
    bool has_gone(std::size_t x, std::size_t y, std::size_t z) const;
    void make_room();
    void drop_unclipped();
    void compute(const Tile& tile, dfield::runtime::volume::LocalFunction* local,
                 const dfield::runtime::volume::LocalPlan& plan, std::uint64_t& voxels);
    void refresh_windows(const Box& voxels) const;

    const Grid grid_;
    const dfield::runtime::volume::Samples samples_;
    const dfield_local_desc local_;
    const bool dilated_mode_;
    const dfield::runtime::volume::LocalRays rays_, rough_rays_;
    const dfield::runtime::volume::Coverage coverage_;
    dfield::runtime::volume::OpacityFunction opacity_;
    std::optional<dfield::runtime::volume::OpacityFunction> next_opacity_;
    // Opacities, clipped as `left_` says if clipped_ is set, otherwise unclipped; and unclipped where some
    // are clipped, through opacity_ if box_filled_ is set.
    dfield::runtime::volume::OpacityVolume volume_;
    dfield::runtime::volume::OpacityBox box_;
    bool clipped_ = false, filled_ = false, box_filled_ = false;
    const dfield::runtime::volume::LocalPlan plan_, rough_plan_;
    dfield::runtime::volume::ExchangeFunction* const exchange_;  // null where blocks are computed afresh
    dfield::runtime::volume::BrickFlags flags_;                  // kDiffers, kChanged, kTurned, kGone
    const dfield::runtime::volume::Stencil rays_reach_, neighbours_reach_;
    dfield::runtime::volume::Buffer<std::uint8_t> left_;
    dfield::runtime::volume::Buffer<float> visibility_;
    const std::array<std::size_t, 3> tiles_;
    // Unclipped factors of the blocks that clips have an effect on; all others have them in visibility_.
    dfield::runtime::volume::BlockStore unclipped_;
    // Blocks of tiles to be computed: unclipped, clipped, roughly.
    std::pmr::vector<std::uint32_t> pending_unclipped_, pending_, pending_rough_;
    // Blocks of tiles whose rays may meet what clips have changed; those with voxels that are gone, too; and
    // those whose factors unclipped_ has.
    std::pmr::vector<std::uint32_t> apart_, affected_, saved_;
    std::pmr::vector<std::uint32_t> order_;  // scratch: tiles that something is to be done in
    std::pmr::vector<Clip> clips_;
    std::pmr::vector<PlacedClip> applied_;
    std::pmr::vector<dfield::runtime::volume::Dilation> dilations_;
    std::uint32_t next_id_ = 1;
};
