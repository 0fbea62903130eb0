#include "baker/cli/runtime_volume.hpp"

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <new>

#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "baker/parallel.hpp"

namespace dfield::cli {
namespace {

std::optional<dfield_sample_type> sample_type(VoxelType type) {
    switch (type) {
        case VoxelType::kU8:
            return DFIELD_SAMPLE_U8;
        case VoxelType::kI8:
            return DFIELD_SAMPLE_I8;
        case VoxelType::kU16:
            return DFIELD_SAMPLE_U16;
        case VoxelType::kI16:
            return DFIELD_SAMPLE_I16;
        case VoxelType::kF32:
            return DFIELD_SAMPLE_F32;
        default:
            return std::nullopt;
    }
}

// The largest cosine between two of the grid's axes, made positive.
double obliqueness(const VolumeGrid& grid) {
    const glm::dvec3 x = glm::normalize(grid.directions[0]), y = glm::normalize(grid.directions[1]),
                     z = glm::normalize(grid.directions[2]);
    return std::max({std::abs(glm::dot(x, y)), std::abs(glm::dot(y, z)), std::abs(glm::dot(z, x))});
}

}  // namespace

RuntimeVolume::RuntimeVolume(std::string name, const Volume& volume, int threads, dfield_context_desc hooks)
    : name_(std::move(name)), voxels_(volume.grid.voxels()) {
    samples_.struct_size = sizeof samples_;
    const glm::dvec3 spacing = volume.grid.spacing();
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t size = volume.grid.size[static_cast<std::size_t>(axis)];
        if (size > DFIELD_MAX_VOLUME_DIM)
            throw InputError(name_ + text(": %zu voxels along an axis; at most %u can be taken", size,
                                          DFIELD_MAX_VOLUME_DIM));
        samples_.grid.dims[axis] = static_cast<std::uint32_t>(size);
        samples_.grid.spacing[axis] = static_cast<float>(spacing[axis]);
    }
    if (const auto type = sample_type(volume.type)) {
        samples_.type = *type;
        samples_.data = volume.data.data();
    } else {
        converted_ = float_values(volume);
        samples_.type = DFIELD_SAMPLE_F32;
        samples_.data = converted_.data();
    }
    hooks.struct_size = sizeof hooks;
    if (thread_count(threads) > 1)
        threads_.emplace(static_cast<unsigned>(thread_count(threads))).install(hooks);
    context_.emplace(&hooks);
}

void RuntimeVolume::rethrow(const Exception& error) const {
    if (error.status() == DFIELD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error.status() == DFIELD_INVALID_ARGUMENT) throw InputError(name_ + ": " + error.what());
    throw error;
}

void RuntimeVolume::check_interrupted() {
    if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
}

void warn_of_oblique_axes(const std::string& name, const VolumeGrid& grid) {
    // A hundredth: half a degree off does no harm and is common in scanners' files.
    if (obliqueness(grid) > 0.01)
        std::fprintf(stderr,
                     "dfield: warning: %s: its axes are not perpendicular; distances are measured as if "
                     "they were\n",
                     name.c_str());
}

glm::dmat4 world_to_frame(const VolumeGrid& grid) {
    const glm::dvec3 spacing = grid.spacing();
    const glm::dmat3 scale(spacing.x, 0, 0, 0, spacing.y, 0, 0, 0, spacing.z);
    const glm::dmat3 linear = scale * glm::inverse(grid.directions);
    glm::dmat4 result(linear);
    result[3] = glm::dvec4(linear * -grid.origin, 1);
    return result;
}

}  // namespace dfield::cli
