// Writes the scalar volumes of volumes.hpp as NRRD files: what `dfield volume` can be tried on. The isovalue
// of all of them is 0.
#include <bit>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "models/volumes.hpp"

namespace dfield::models {
namespace {

void write_nrrd(const std::filesystem::path& path, const ScalarVolume& volume) {
    static_assert(std::endian::native == std::endian::little);
    char header[256];
    const int length = std::snprintf(header, sizeof header,
                                     "NRRD0004\ntype: float\ndimension: 3\nsizes: %u %u %u\nspacings: %g %g "
                                     "%g\nendian: little\nencoding: raw\n\n",
                                     volume.dims[0], volume.dims[1], volume.dims[2], volume.spacing[0],
                                     volume.spacing[1], volume.spacing[2]);
    std::ofstream file(path, std::ios::binary);
    file.write(header, length);
    file.write(reinterpret_cast<const char*>(volume.values.data()),
               static_cast<std::streamsize>(volume.values.size() * sizeof(float)));
    if (!file.flush())
        throw std::runtime_error("cannot write " + path.string() + "; is the folder writable?");
    std::printf("%s: %u x %u x %u\n", path.string().c_str(), volume.dims[0], volume.dims[1], volume.dims[2]);
}

void generate(const std::filesystem::path& folder, std::uint32_t size) {
    std::filesystem::create_directories(folder);
    const Dims dims{size, size, size};
    const double middle = 0.5 * (size - 1);
    write_nrrd(folder / "sphere.nrrd", sphere_volume(dims, {middle, middle, middle}, 0.3 * size));
    write_nrrd(folder / "gyroid.nrrd", gyroid_volume(dims, size * 6 / 128.0));
    write_nrrd(folder / "floor.nrrd", floor_volume(dims));
    write_nrrd(folder / "vessels.nrrd", vessels_volume(dims, 1));
    write_nrrd(folder / "clouds.nrrd", clouds_volume(dims, 1));
}

}  // namespace
}  // namespace dfield::models

int main(int argc, char** argv) {
    std::uint32_t size = 128;
    const std::string asked = argc == 3 ? argv[2] : "128";
    const auto [end, error] = std::from_chars(asked.data(), asked.data() + asked.size(), size);
    if (argc < 2 || argc > 3 || error != std::errc() || *end != '\0' || size < 8 || size > 1024) {
        std::fprintf(stderr,
                     "usage: dfield_generate_volumes FOLDER [SIZE]\nWrites the project's own volumes into "
                     "FOLDER, SIZE voxels (8 to 1024; 128) along each axis.\n");
        return 2;
    }
    try {
        dfield::models::generate(argv[1], size);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "dfield_generate_volumes: %s\n", error.what());
        return 1;
    }
}
