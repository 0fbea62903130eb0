#include "format/occlusion_volume.hpp"

#include "format/octahedral.hpp"

namespace dfield {

glm::vec3 far_direction(std::uint32_t far_size, std::uint32_t s, std::uint32_t t) {
    const float scale = 2.0f / static_cast<float>(far_size - 1);
    return octahedral_direction({static_cast<float>(s) * scale - 1, static_cast<float>(t) * scale - 1});
}

std::string volume_dims_error(const std::array<std::uint32_t, 3>& dims, std::uint32_t far_size) {
    for (const std::uint32_t dim : dims)
        if (dim < kMinVolumeSize || dim > kMaxVolumeSize)
            return "an occlusion volume of " + std::to_string(dims[0]) + " x " + std::to_string(dims[1]) +
                   " x " + std::to_string(dims[2]) + " samples has a side outside " +
                   std::to_string(kMinVolumeSize) + ".." + std::to_string(kMaxVolumeSize);
    if (far_size < kMinFarSize || far_size > kMaxFarSize || far_size % 2 == 0)
        return "an occlusion volume's map of balls of size " + std::to_string(far_size) +
               " is not odd and within " + std::to_string(kMinFarSize) + ".." + std::to_string(kMaxFarSize);
    const std::uint64_t bytes =
        8 * std::uint64_t{dims[0]} * dims[1] * dims[2] + 4 * std::uint64_t{far_size} * far_size;
    if (bytes > kMaxVolumeBytes)
        return "the occlusion volume would take " + std::to_string(bytes) +
               " bytes, more than the format's " + std::to_string(kMaxVolumeBytes) + "; lower its resolution";
    return {};
}

}  // namespace dfield
