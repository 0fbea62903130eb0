#include "volume/clip_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "status.hpp"

namespace dfield::runtime::volume {

PlacedClip::PlacedClip(const dfield_clip& clip, const Grid& grid)
    : mesh(clip.mesh), probe(clip.mode == DFIELD_CLIP_PROBE) {
    require(mesh, "clip: its mesh is null; create one first");
    require(clip.mode <= DFIELD_CLIP_PROBE, "clip: unknown mode; SUBTRACT and PROBE are known");
    const float* const m = clip.mesh_to_world;
    for (int i = 0; i < 16; ++i) require(std::isfinite(m[i]), "clip: mesh_to_world is not finite");
    require(m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1, "clip: mesh_to_world is not affine");
    const glm::dmat3 linear(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    const glm::dmat3 inverse = glm::inverse(linear);
    bool regular = true;
    for (int axis = 0; axis < 3; ++axis)
        regular = regular && std::isfinite(inverse[axis].x + inverse[axis].y + inverse[axis].z);
    require(regular, "clip: mesh_to_world is singular");
    const double spacing[3] = {static_cast<double>(grid.hx), static_cast<double>(grid.hy),
                               static_cast<double>(grid.hz)};
    for (int axis = 0; axis < 3; ++axis) column[axis] = mesh->to_camera(inverse[axis] * spacing[axis]);
    origin = mesh->to_camera(inverse * -glm::dvec3(m[12], m[13], m[14]));
}

void PlacedClip::bounds(const Grid& grid, std::size_t low[3], std::size_t high[3]) const {
    const glm::dmat3 to_voxels = glm::inverse(glm::dmat3(column[0], column[1], column[2]));
    const glm::dvec3 middle = to_voxels * ((mesh->low() + mesh->high()) * 0.5 - origin),
                     half = (mesh->high() - mesh->low()) * 0.5,
                     box = glm::abs(to_voxels[0]) * half.x + glm::abs(to_voxels[1]) * half.y +
                           glm::abs(to_voxels[2]) * half.z;
    const std::size_t n[3] = {grid.nx, grid.ny, grid.nz};
    for (int axis = 0; axis < 3; ++axis) {
        constexpr double kMargin = 2;
        const auto end = static_cast<double>(n[axis]);
        low[axis] = static_cast<std::size_t>(std::clamp(middle[axis] - box[axis] - kMargin, 0.0, end));
        high[axis] = static_cast<std::size_t>(std::clamp(middle[axis] + box[axis] + kMargin + 1, 0.0, end));
    }
}

Coverage::Coverage(dfield_context* context, std::size_t samples)
    : samples_(samples),
      all_(static_cast<std::uint8_t>(samples > 0 ? samples + 9 : 1)),
      clip_(clip_function(context->simd_targets)),
      offsets_{std::pmr::vector<double>(context), std::pmr::vector<double>(context),
               std::pmr::vector<double>(context)},
      shares_(context) {
    // The additive sequence of the plastic number's powers (M. Roberts): even, and the same everywhere.
    constexpr double kPlastic = 1.2207440846057596;
    double power = 1;
    for (auto& offsets : offsets_) {
        power /= kPlastic;
        for (std::size_t i = 0; i < samples; ++i) {
            const double at = 0.5 + power * static_cast<double>(i + 1);
            offsets.push_back(2 * (at - std::floor(at)) - 1);
        }
    }
    for (std::size_t left = 0; left <= all_; ++left)
        shares_.push_back(static_cast<float>(left) / static_cast<float>(all_));
}

std::uint8_t Coverage::of_voxel(std::span<const PlacedClip> clips, std::size_t x, std::size_t y,
                                std::size_t z) const {
    // Lines 24 and 25, with section 3.6: a sample is visible where no clip takes it away.
    const auto visible = [&](double px, double py, double pz) {
        for (const PlacedClip& clip : clips)
            if (clip.clips(clip.to_camera(px, py, pz))) return false;
        return true;
    };
    const auto px = static_cast<double>(x), py = static_cast<double>(y), pz = static_cast<double>(z);
    std::size_t left = visible(px, py, pz);
    if (samples_ == 0) return static_cast<std::uint8_t>(left);
    for (int corner = 0; corner < 8; ++corner)
        left += visible(px + (corner & 1) - 0.5, py + (corner >> 1 & 1) - 0.5, pz + (corner >> 2) - 0.5);
    if (left == 9) return all_;
    if (left == 0) return 0;
    for (std::size_t i = 0; i < samples_; ++i)
        left += visible(px + offsets_[0][i], py + offsets_[1][i], pz + offsets_[2][i]);
    return static_cast<std::uint8_t>(left);
}

namespace {

// What most boxes of voxels are: on one side of every clip's boundary. Clips whose boundary may pass are kept
// in `kept`. Samples lie within 1 voxel of their voxel's centre.
enum class Sides { kSeen, kGone, kMixed };
template<class Clips, class Keep>
Sides sides_of(const Clips& clips, const std::size_t (&low)[3], const std::size_t (&size)[3],
               const Keep& keep) {
    double middle[3], half[3];
    for (int axis = 0; axis < 3; ++axis) {
        half[axis] = static_cast<double>(size[axis] + 1) / 2;
        middle[axis] = static_cast<double>(low[axis]) + static_cast<double>(size[axis] - 1) / 2;
    }
    bool mixed = false;
    for (const PlacedClip* clip : clips) {
        const auto side = clip->mesh->side(clip->to_camera(middle[0], middle[1], middle[2]),
                                           clip->half_box(half[0], half[1], half[2]));
        if (side == dfield_clip_mesh::Side::kMixed) {
            keep(clip);
            mixed = true;
        } else if ((side == dfield_clip_mesh::Side::kInside) != clip->probe) {
            return Sides::kGone;
        }
    }
    return mixed ? Sides::kMixed : Sides::kSeen;
}

// Clips by their addresses, few enough for the stack.
struct ClipList {
    static constexpr std::size_t kMost = 64;
    std::array<const PlacedClip*, kMost> clips;
    std::size_t count = 0;

    const PlacedClip* const* begin() const { return clips.data(); }
    const PlacedClip* const* end() const { return clips.data() + count; }
};

}  // namespace

bool Coverage::of_block(std::span<const PlacedClip> clips, std::size_t x, std::size_t y, std::size_t z,
                        std::uint8_t* left) const {
    if (clips.size() > ClipList::kMost) {
        for (std::size_t i = 0; i < kBlock; ++i)
            left[i] =
                of_voxel(clips, x + i % kBlockX, y + i / kBlockX % kBlockY, z + i / (kBlockX * kBlockY));
        return true;
    }
    ClipList all, near;
    for (const PlacedClip& clip : clips) all.clips[all.count++] = &clip;
    const auto add_to = [](ClipList& list) {
        return [&list](const PlacedClip* clip) { list.clips[list.count++] = clip; };
    };
    const Sides block = sides_of(all, {x, y, z}, {kBlockX, kBlockY, kBlockZ}, add_to(near));
    if (block == Sides::kSeen) return false;
    std::fill_n(left, kBlock, block == Sides::kGone ? std::uint8_t{0} : all_);
    if (block == Sides::kGone) return true;
    static_assert(kBrickY == kBlockY && kBrickZ == kBlockZ);
    for (std::size_t i = 0; i < kBlockX; i += kBrickX) {
        ClipList nearer;
        const Sides brick = sides_of(near, {x + i, y, z}, {kBrickX, kBrickY, kBrickZ}, add_to(nearer));
        if (brick == Sides::kGone)
            for (std::size_t row = 0; row < kBlockY * kBlockZ; ++row)
                std::fill_n(left + row * kBlockX + i, kBrickX, std::uint8_t{0});
        else if (brick == Sides::kMixed)
            of_brick({nearer.begin(), nearer.count}, x + i, y, z, left + i);
    }
    return true;
}

void Coverage::of_brick(std::span<const PlacedClip* const> clips, std::size_t x, std::size_t y, std::size_t z,
                        std::uint8_t* left) const {
    constexpr std::size_t kVoxels = kBrickX * kBrickY * kBrickZ, kRow = kBrickX + 1,
                          kSlice = kRow * (kBrickY + 1), kCorners = kSlice * (kBrickZ + 1);
    constexpr std::size_t kMost = std::max(kVoxels + kCorners, std::size_t{DFIELD_MAX_CLIP_SAMPLES}) + 16;
    std::array<double, kMost> px, py, pz;
    std::array<std::uint8_t, kMost> seen;
    std::size_t count = 0;
    const auto add = [&](double ax, double ay, double az) {
        px[count] = ax;
        py[count] = ay;
        pz[count++] = az;
    };
    const auto test = [&] {
        std::fill_n(seen.begin(), count, std::uint8_t{1});
        for (const PlacedClip* clip : clips)
            clip_(*clip, {px.data(), py.data(), pz.data(), count}, seen.data());
    };
    const auto fx = static_cast<double>(x), fy = static_cast<double>(y), fz = static_cast<double>(z);
    for (std::size_t k = 0; k < kBrickZ; ++k)
        for (std::size_t j = 0; j < kBrickY; ++j)
            for (std::size_t i = 0; i < kBrickX; ++i)
                add(fx + static_cast<double>(i), fy + static_cast<double>(j), fz + static_cast<double>(k));
    if (samples_ > 0)  // corners belong to eight voxels: each is tested once
        for (std::size_t k = 0; k <= kBrickZ; ++k)
            for (std::size_t j = 0; j <= kBrickY; ++j)
                for (std::size_t i = 0; i <= kBrickX; ++i)
                    add(fx + static_cast<double>(i) - 0.5, fy + static_cast<double>(j) - 0.5,
                        fz + static_cast<double>(k) - 0.5);
    test();
    std::array<std::uint8_t, kVoxels> found;
    for (std::size_t i = 0; i < kVoxels; ++i) {
        std::size_t sum = seen[i];
        if (samples_ > 0) {
            const std::uint8_t* const c = &seen[kVoxels + i / (kBrickX * kBrickY) * kSlice +
                                                i / kBrickX % kBrickY * kRow + i % kBrickX];
            for (const std::size_t at : {std::size_t{0}, kRow, kSlice, kSlice + kRow})
                sum += c[at] + std::size_t{c[at + 1]};
            if (sum == 9) sum = all_;
        }
        found[i] = static_cast<std::uint8_t>(sum);
    }
    for (std::size_t i = 0; i < kVoxels; ++i) {
        const std::size_t bx = i % kBrickX, by = i / kBrickX % kBrickY, bz = i / (kBrickX * kBrickY);
        if (samples_ > 0 && found[i] != 0 && found[i] != all_) {
            count = 0;
            const double cx = fx + static_cast<double>(bx), cy = fy + static_cast<double>(by),
                         cz = fz + static_cast<double>(bz);
            for (std::size_t s = 0; s < samples_; ++s)
                add(cx + offsets_[0][s], cy + offsets_[1][s], cz + offsets_[2][s]);
            test();
            for (std::size_t s = 0; s < samples_; ++s)
                found[i] = static_cast<std::uint8_t>(found[i] + seen[s]);
        }
        left[(bz * kBlockY + by) * kBlockX + bx] = found[i];
    }
}

}  // namespace dfield::runtime::volume
