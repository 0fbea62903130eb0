#include "bench/volume/subjects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "baker/volume/read_volume.hpp"

namespace dfield::volumes {
namespace {

struct Scan {
    const char *name, *file;
    float isovalue;
};
constexpr Scan kScans[] = {{"bonsai", "bonsai_256x256x256_uint8.nrrd", 40},
                           {"engine", "engine_256x256x128_uint8.nrrd", 100},
                           {"head", "headsq_64x64x93_int16.nrrd", 700},
                           {"nucleon", "nucleon.nrrd", 100}};

VolumeGrid grid_of(const models::ScalarVolume& values) {
    VolumeGrid grid;
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        grid.size[i] = values.dims[i];
        grid.directions[axis][axis] = values.spacing[i];
    }
    return grid;
}

}  // namespace

Subject as_floats(std::string name, const models::ScalarVolume& values) {
    Subject subject{std::move(name), {grid_of(values), VoxelType::kF32, {}}, 0};
    subject.volume.data.resize(values.values.size() * sizeof(float));
    std::memcpy(subject.volume.data.data(), values.values.data(), subject.volume.data.size());
    return subject;
}

Subject as_bytes(std::string name, const models::ScalarVolume& values, double scale) {
    constexpr double kMiddle = 127.5;
    Subject subject{std::move(name), {grid_of(values), VoxelType::kU8, {}}, static_cast<float>(kMiddle)};
    subject.volume.data.reserve(values.values.size());
    for (const float value : values.values)
        subject.volume.data.push_back(
            static_cast<std::byte>(std::clamp(kMiddle + scale * value + 0.5, 0.0, 255.0)));
    return subject;
}

Subject padded(const Subject& subject, std::size_t voxels) {
    const Volume& from = subject.volume;
    Subject result{subject.name, {from.grid, from.type, {}}, subject.isovalue};
    Volume& to = result.volume;
    for (std::size_t& size : to.grid.size) size += 2 * voxels;
    to.data.resize(to.grid.voxels() * size_of(to.type));
    visit_type(to.type, [&](auto voxel) {
        using T = decltype(voxel);
        const std::span<const T> source = from.voxels<T>();
        const std::span<T> target = to.voxels<T>();
        std::fill(target.begin(), target.end(), static_cast<T>(value_range(from).min));
        const auto [nx, ny, nz] = from.grid.size;
        for (std::size_t row = 0; row < ny * nz; ++row) {
            const std::size_t y = row % ny + voxels, z = row / ny + voxels;
            std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(row * nx), nx,
                        target.begin() + static_cast<std::ptrdiff_t>(voxels + to.grid.size[0] *
                                                                                  (y + to.grid.size[1] * z)));
        }
    });
    return result;
}

Subject slab_with_boxes(std::uint32_t size) {
    const std::uint32_t n = size - 2 * kAir;
    return padded(as_floats("floor with boxes", models::floor_volume({n, n, n})), kAir);
}

Subject tangled_vessels(std::uint32_t size) {
    constexpr int kRoots = 30;
    const std::uint32_t n = size - 2 * kAir;
    return padded(as_floats("vessels", models::vessels_volume({n, n, n}, 1, kRoots)), kAir);
}

Subject timed_subject(models::Dims dims) {
    return as_bytes("gyroid", models::gyroid_volume(dims, kGyroidPeriods), 80);
}

Subject timed_subject(std::uint32_t size) {
    return timed_subject(models::Dims{size, size, size});
}

const Subject* Stock::shared(const std::string& name) {
    const auto at = loaded_.find(name);
    if (at != loaded_.end()) return &at->second;
    for (const Scan& scan : kScans) {
        if (name != scan.name) continue;
        const std::filesystem::path file = shared_ / scan.file;
        if (quick_ || !std::filesystem::exists(file)) return nullptr;
        return &loaded_.emplace(name, Subject{name, read_volume(file), scan.isovalue}).first->second;
    }
    throw std::logic_error("no scan is named " + name);
}

std::span<const char* const> Stock::shared_names() {
    static constexpr auto kNames = [] {
        std::array<const char*, std::size(kScans)> names{};
        for (std::size_t i = 0; i < names.size(); ++i) names[i] = kScans[i].name;
        return names;
    }();
    return kNames;
}

}  // namespace dfield::volumes
