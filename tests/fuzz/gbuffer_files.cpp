// libFuzzer: G-buffer files. The first byte says what the rest is: an OpenEXR file, or a JSON that ends with
// a zero byte and the PNG that it may name as a.png. A file is refused, or is a buffer that holds what it
// says.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include "baker/error.hpp"
#include "baker/screen/gbuffer.hpp"
#include "tests/fuzz/folder.hpp"

namespace {

using namespace dfield;

using fuzz::folder;
using fuzz::require;
using fuzz::write;

void check(const GBuffer& buffer) {
    require(buffer.width > 0 && buffer.width <= kMaxScreenSide && buffer.height > 0 &&
            buffer.height <= kMaxScreenSide);
    require(buffer.depth.size() == buffer.pixels());
    for (const auto* values : {&buffer.normals, &buffer.albedo, &buffer.radiance})
        require(values->empty() || values->size() == buffer.pixels());
    for (const float depth : buffer.depth) require(depth > 0);
    const ScreenCamera& camera = buffer.camera;
    require(camera.half_width > 0 && camera.half_height > 0 && std::isfinite(camera.offset.x) &&
            std::isfinite(camera.offset.y));

    const std::filesystem::path path = folder() / "again.exr";
    write_gbuffer(path, buffer);
    const GBuffer again = read_gbuffer(path);
    const auto same = [](const auto& a, const auto& b) {  // NaN too
        return a.size() == b.size() &&
               (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
    };
    require(again.width == buffer.width && again.height == buffer.height && same(again.depth, buffer.depth) &&
            same(again.normals, buffer.normals) && same(again.albedo, buffer.albedo) &&
            same(again.radiance, buffer.radiance) && again.camera.to_world == camera.to_world &&
            again.camera.offset == camera.offset);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string rest(reinterpret_cast<const char*>(data + 1), size - 1);
    std::filesystem::path path;
    if (data[0] % 2 == 0) {
        path = write("a.exr", rest);
    } else {
        const std::size_t zero = std::min(rest.find('\0'), rest.size());
        path = write("a.json", rest.substr(0, zero));
        write("a.png", zero < rest.size() ? rest.substr(zero + 1) : std::string());
    }
    ScreenCamera lens;
    lens.half_height = 0.5f;
    try {
        check(read_gbuffer(path, data[0] & 2 ? &lens : nullptr));
    } catch (const InputError& error) {
        require(std::string(error.what()).find(folder().string()) != std::string::npos);
    }
    return 0;
}
