// Volume files byte by byte, written without the libraries that read them.
#pragma once

#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "baker/error.hpp"
#include "baker/volume/read_volume.hpp"
#include "tests/import/test_files.hpp"
#include "tests/volume_files/gzip.hpp"

namespace dfield::test {

// Numbers of 8 to 64 bits, some of them at the ends of their type's range, 2 x 3 x 2 of them.
template<class T>
std::vector<T> sample_voxels() {
    using Limits = std::numeric_limits<T>;
    return {
        Limits::lowest(), Limits::max(), T(0), T(1), T(2), T(100), T(7), T(31), T(63), T(64), T(65), T(126)};
}

// 2 x 3 x 2 bytes, as a file has them and as they are read.
inline const std::string kVoxels("\0\1\2\3\4\5\6\7\10\11\12\13", 12);
inline const std::vector<std::uint8_t> kValues{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

template<class T>
std::string bytes_of_all(const std::vector<T>& values, bool big_endian = false) {
    std::string bytes;
    for (const T value : values) bytes += bytes_of<T>({value}, big_endian);
    return bytes;
}

template<class T>
std::vector<T> voxels_of(const Volume& volume) {
    const auto voxels = volume.voxels<T>();
    return {voxels.begin(), voxels.end()};
}

// An attached NRRD: the fields that all have, `more` lines, a blank line, the voxels.
inline std::string nrrd(const std::string& type, const std::string& sizes, const std::string& more,
                        const std::string& voxels) {
    const auto axes = 1 + std::count(sizes.begin(), sizes.end(), ' ');
    return "NRRD0004\ntype: " + type + "\ndimension: " + std::to_string(axes) + "\nsizes: " + sizes + "\n" +
           more + "\n" + voxels;
}

// A NIfTI-1 header, field by field as nifti1.h's comments number the bytes; 352 bytes with the extension
// flag.
class NiftiHeader {
  public:
    explicit NiftiHeader(bool big_endian = false, bool pair = false) : big_(big_endian), bytes_(352, '\0') {
        set<std::int32_t>(0, 348);
        put(344, pair ? std::string("ni1\0", 4) : std::string("n+1\0", 4));
        set<float>(108, pair ? 0.0f : 352.0f);
        for (const std::size_t axis : {1, 2, 3}) set<float>(76 + 4 * axis, 1);
        if (pair) bytes_.resize(348);
    }
    NiftiHeader& dims(const std::vector<std::int16_t>& sizes) {
        set(40, static_cast<std::int16_t>(sizes.size()));
        for (std::size_t i = 0; i < sizes.size(); ++i) set(42 + 2 * i, sizes[i]);
        return *this;
    }
    NiftiHeader& type(int datatype, int bits) {
        set(70, static_cast<std::int16_t>(datatype));
        set(72, static_cast<std::int16_t>(bits));
        return *this;
    }
    NiftiHeader& spacing(float x, float y, float z) {
        set<float>(80, x);
        set<float>(84, y);
        set<float>(88, z);
        return *this;
    }
    NiftiHeader& scale(float slope, float intercept) {
        set<float>(112, slope);
        set<float>(116, intercept);
        return *this;
    }
    NiftiHeader& qform(float qfac, const std::vector<float>& bcd, const std::vector<float>& offset) {
        set<std::int16_t>(252, 1);
        set<float>(76, qfac);
        for (std::size_t i = 0; i < 3; ++i) set<float>(256 + 4 * i, bcd[i]);
        for (std::size_t i = 0; i < 3; ++i) set<float>(268 + 4 * i, offset[i]);
        return *this;
    }
    NiftiHeader& sform(const std::vector<float>& rows) {
        set<std::int16_t>(254, 1);
        for (std::size_t i = 0; i < 12; ++i) set<float>(280 + 4 * i, rows[i]);
        return *this;
    }
    NiftiHeader& units(char unit) {
        bytes_[123] = unit;
        return *this;
    }
    template<class T>
    NiftiHeader& set(std::size_t at, T value) {
        put(at, bytes_of<T>({value}, big_));
        return *this;
    }
    const std::string& bytes() const { return bytes_; }

  private:
    void put(std::size_t at, const std::string& bytes) { bytes_.replace(at, bytes.size(), bytes); }

    bool big_;
    std::string bytes_;
};

// 2 x 3 x 2 voxels of u8.
inline NiftiHeader small_nifti(bool big_endian = false, bool pair = false) {
    return NiftiHeader(big_endian, pair).dims({2, 3, 2}).type(2, 8);
}

// What reading the file says is wrong with it.
inline std::string error_of(const std::filesystem::path& path, const VolumeReadOptions& options = {}) {
    try {
        read_volume(path, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

inline void check_vector(const glm::dvec3& value, const glm::dvec3& expected, double tolerance = 1e-12) {
    INFO(value.x << " " << value.y << " " << value.z << " instead of " << expected.x << " " << expected.y
                 << " " << expected.z);
    for (int i = 0; i < 3; ++i) CHECK(std::abs(value[i] - expected[i]) <= tolerance);
}

}  // namespace dfield::test
