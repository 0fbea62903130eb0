// Small G-buffers, and files of them.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/screen/gbuffer.hpp"
#include "tests/import/test_files.hpp"

namespace dfield::test {

constexpr float kSky = std::numeric_limits<float>::infinity();

// Every pixel different, one of sky, all buffers there.
inline GBuffer small_buffer() {
    GBuffer buffer;
    buffer.width = 7;
    buffer.height = 5;
    buffer.camera.half_width = 0.7f;
    buffer.camera.half_height = 0.5f;
    buffer.camera.offset = {0.125f, -0.25f};
    buffer.camera.near = 0.5f;
    buffer.camera.to_world[3] = {1, 2, 3, 1};
    for (std::size_t i = 0; i < buffer.pixels(); ++i) {
        const auto x = static_cast<float>(i);
        buffer.depth.push_back(2 + 0.1f * x);
        buffer.normals.push_back(glm::normalize(glm::vec3(std::sin(x), std::cos(x), 1.5f)));
        buffer.albedo.push_back({0.02f * x, 0.5f, 1 - 0.02f * x});
        buffer.radiance.push_back({0.1f * x, 0.25f, 1});
    }
    buffer.depth[9] = kSky;
    buffer.normals[9] = glm::vec3(0);
    return buffer;
}

inline std::string text_of(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What reading it says is wrong.
inline std::string error_of(const std::filesystem::path& path) {
    try {
        read_gbuffer(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace dfield::test
