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
    require(mesh, "clip: mesh is null");
    require(clip.mode <= DFIELD_CLIP_PROBE, "clip: unknown mode");
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

Coverage::Coverage(std::pmr::memory_resource* memory, std::size_t samples)
    : samples_(samples),
      all_(static_cast<std::uint8_t>(samples > 0 ? samples + 9 : 1)),
      offsets_(memory),
      shares_(kMost + 1, 1.0f, memory) {
    // The additive sequence of the plastic number's powers (M. Roberts): even, and the same everywhere.
    constexpr double kPlastic = 1.2207440846057596;
    for (std::size_t i = 0; i < samples; ++i) {
        glm::dvec3 offset;
        double power = 1;
        for (int axis = 0; axis < 3; ++axis) {
            power /= kPlastic;
            const double at = 0.5 + power * static_cast<double>(i + 1);
            offset[axis] = 2 * (at - std::floor(at)) - 1;
        }
        offsets_.push_back(offset);
    }
    for (std::size_t left = 0; left <= all_; ++left)
        shares_[left] = static_cast<float>(left) / static_cast<float>(all_);
}

namespace {

// Lines 24 and 25, with section 3.6: a sample is visible where no clip takes it away.
bool visible(std::span<const PlacedClip> clips, double x, double y, double z) {
    for (const PlacedClip& clip : clips)
        if (clip.clips(clip.to_camera(x, y, z))) return false;
    return true;
}

}  // namespace

std::uint8_t Coverage::of_voxel(std::span<const PlacedClip> clips, std::size_t x, std::size_t y,
                                std::size_t z) const {
    const auto px = static_cast<double>(x), py = static_cast<double>(y), pz = static_cast<double>(z);
    std::size_t left = visible(clips, px, py, pz);
    if (samples_ == 0) return static_cast<std::uint8_t>(left);
    for (int corner = 0; corner < 8; ++corner)
        left +=
            visible(clips, px + (corner & 1) - 0.5, py + (corner >> 1 & 1) - 0.5, pz + (corner >> 2) - 0.5);
    if (left == 9) return all_;
    if (left == 0) return 0;
    for (const glm::dvec3& offset : offsets_)
        left += visible(clips, px + offset.x, py + offset.y, pz + offset.z);
    return static_cast<std::uint8_t>(left);
}

bool Coverage::of_block(std::span<const PlacedClip> clips, std::size_t x, std::size_t y, std::size_t z,
                        std::uint8_t* left) const {
    constexpr std::size_t kBlock = kBlockX * kBlockY * kBlockZ;
    // Which clips the block needs tests against: most have one side for all of it.
    constexpr std::size_t kTested = 16;
    std::array<std::uint32_t, kTested> tested;
    std::size_t count = 0;
    bool overflow = false;
    for (std::size_t i = 0; i < clips.size(); ++i) {
        const PlacedClip& clip = clips[i];
        const auto centre = clip.to_camera(static_cast<double>(x) + (kBlockX - 1) / 2.0,
                                           static_cast<double>(y) + (kBlockY - 1) / 2.0,
                                           static_cast<double>(z) + (kBlockZ - 1) / 2.0);
        const auto side = clip.mesh->side(
            centre, clip.half_box((kBlockX + 1) / 2.0, (kBlockY + 1) / 2.0, (kBlockZ + 1) / 2.0));
        if (side == dfield_clip_mesh::Side::kMixed) {
            if (count < kTested)
                tested[count++] = static_cast<std::uint32_t>(i);
            else
                overflow = true;
        } else if ((side == dfield_clip_mesh::Side::kInside) != clip.probe) {
            std::fill_n(left, kBlock, std::uint8_t{0});
            return true;
        }
    }
    if (count == 0) return false;
    if (overflow) {
        for (std::size_t i = 0; i < kBlock; ++i)
            left[i] =
                of_voxel(clips, x + i % kBlockX, y + i / kBlockX % kBlockY, z + i / (kBlockX * kBlockY));
        return true;
    }
    const auto sees = [&](double px, double py, double pz) {
        for (std::size_t i = 0; i < count; ++i) {
            const PlacedClip& clip = clips[tested[i]];
            if (clip.clips(clip.to_camera(px, py, pz))) return false;
        }
        return true;
    };
    const auto fx = static_cast<double>(x), fy = static_cast<double>(y), fz = static_cast<double>(z);
    // Corners belong to eight voxels: each is tested once.
    std::uint8_t corners[(kBlockZ + 1) * (kBlockY + 1) * (kBlockX + 1)];
    if (samples_ > 0) {
        std::uint8_t* corner = corners;
        for (std::size_t k = 0; k <= kBlockZ; ++k)
            for (std::size_t j = 0; j <= kBlockY; ++j)
                for (std::size_t i = 0; i <= kBlockX; ++i)
                    *corner++ = sees(fx + static_cast<double>(i) - 0.5, fy + static_cast<double>(j) - 0.5,
                                     fz + static_cast<double>(k) - 0.5);
    }
    for (std::size_t k = 0; k < kBlockZ; ++k)
        for (std::size_t j = 0; j < kBlockY; ++j)
            for (std::size_t i = 0; i < kBlockX; ++i, ++left) {
                const double px = fx + static_cast<double>(i), py = fy + static_cast<double>(j),
                             pz = fz + static_cast<double>(k);
                std::size_t seen = sees(px, py, pz);
                if (samples_ > 0) {
                    constexpr std::size_t kRow = kBlockX + 1, kSlice = kRow * (kBlockY + 1);
                    const std::uint8_t* const c = corners + (k * kSlice + j * kRow + i);
                    for (const std::size_t at : {std::size_t{0}, kRow, kSlice, kSlice + kRow})
                        seen += c[at] + std::size_t{c[at + 1]};
                    if (seen == 9)
                        seen = all_;
                    else if (seen > 0)
                        for (const glm::dvec3& o : offsets_) seen += sees(px + o.x, py + o.y, pz + o.z);
                }
                *left = static_cast<std::uint8_t>(seen);
            }
    return true;
}

}  // namespace dfield::runtime::volume
