// Files for import tests: a folder that goes away with the test, and bytes written into it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "baker/mesh.hpp"

namespace dfield::test {

class TestFolder {
  public:
    TestFolder() {
        std::random_device random;
        path_ = std::filesystem::temp_directory_path() /
                ("dfield-test-" + std::to_string(random()) + std::to_string(random()));
        std::filesystem::create_directories(path_);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::filesystem::remove(path_ /
                                name);  // ext4 waits for the disk where a file is cut to nothing instead
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }
    std::size_t files() const {
        using Iterator = std::filesystem::directory_iterator;
        return static_cast<std::size_t>(std::distance(Iterator(path_), Iterator()));
    }

  private:
    std::filesystem::path path_;
};

// The bytes of little-endian (or reversed) numbers.
template<class T>
std::string bytes_of(std::initializer_list<T> values, bool big_endian = false) {
    std::string bytes;
    for (const T value : values) {
        const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
        for (std::size_t i = 0; i < raw.size(); ++i)
            bytes.push_back(raw[big_endian ? raw.size() - 1 - i : i]);
    }
    return bytes;
}

inline double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

}  // namespace dfield::test
