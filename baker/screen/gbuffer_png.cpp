// G-buffers as PNGs beside a JSON file that says what their numbers mean.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/import/gltf_uri.hpp"
#include "baker/screen/gbuffer_formats.hpp"
#include "baker/screen/png_channels.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr float kMost = 65535;  // of 16 bits

std::uint16_t coded(float unit) {
    return static_cast<std::uint16_t>(std::lround(kMost * (unit > 0 ? std::min(unit, 1.0f) : 0.0f)));
}

class PngReader {
  public:
    PngReader(const fs::path& path, const json& description)
        : where_(path.string()),
          folder_(path.has_parent_path() ? path.parent_path() : fs::path(".")),
          description_(description) {}

    GBuffer read(const ScreenCamera* lens) {
        if (!description_.contains("depth")) throw InputError(where_ + ": names no depth");
        const json& depth = entry("depth");
        const PngChannels picture = channels("depth", depth, 1);
        buffer_.width = picture.width;
        buffer_.height = picture.height;
        buffer_.camera = read_camera_json(where_, description_, lens, picture.width, picture.height);
        const bool device = depth_is_device(where_, description_, buffer_.camera);
        const double from = read_number(where_ + ": depth", depth, "from", 0),
                     to = read_number(where_ + ": depth", depth, "to", 1);
        if (!device && !(to > from)) throw InputError(where_ + ": depth: to is not above from");
        for (const std::uint16_t value : picture.values) {
            const double unit = value / double{kMost};
            buffer_.depth.push_back(device ? depth_of_device(buffer_.camera, static_cast<float>(unit))
                                    : value == 0xffff ? std::numeric_limits<float>::infinity()
                                                      : static_cast<float>(from + unit * (to - from)));
        }
        vectors("normals", buffer_.normals, [](const glm::vec3& v, double) {
            const glm::vec3 normal = 2.0f * v - 1.0f;
            const float length = glm::length(normal);
            return length > 0.1f ? normal / length : glm::vec3(0);
        });
        const auto scaled = [](const glm::vec3& v, double scale) { return static_cast<float>(scale) * v; };
        vectors("albedo", buffer_.albedo, scaled);
        vectors("radiance", buffer_.radiance, scaled);
        return std::move(buffer_);
    }

  private:
    const json& entry(const char* name) const {
        const json& entry = description_.at(name);
        if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string())
            throw InputError(where_ + ": " + name + " is no object with a file");
        return entry;
    }

    PngChannels channels(const char* name, const json& entry, int count) const {
        const auto file = relative_path_of_uri(entry["file"].get<std::string>());
        if (!file) throw InputError(where_ + ": " + name + ": its file is no relative path");
        return read_png_channels(folder_ / *file, count);
    }

    template<class Decode>
    void vectors(const char* name, std::vector<glm::vec3>& target, const Decode& decode) {
        if (!description_.contains(name)) return;
        const json& source = entry(name);
        const PngChannels picture = channels(name, source, 3);
        if (picture.width != buffer_.width || picture.height != buffer_.height)
            throw InputError(where_ + ": " + name + " has " + std::to_string(picture.width) + " x " +
                             std::to_string(picture.height) + " pixels, the depth " +
                             std::to_string(buffer_.width) + " x " + std::to_string(buffer_.height));
        const double scale = read_number(where_ + ": " + name, source, "scale", 1);
        for (std::size_t i = 0; i < picture.values.size(); i += 3)
            target.push_back(decode(
                glm::vec3(picture.values[i], picture.values[i + 1], picture.values[i + 2]) / kMost, scale));
    }

    std::string where_;
    fs::path folder_;
    const json& description_;
    GBuffer buffer_;
};

}  // namespace

GBuffer read_png_gbuffer(const fs::path& path, const ScreenCamera* lens) {
    const std::vector<std::byte> bytes = read_file(path);
    const json description =
        parse_gbuffer_json(path.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return PngReader(path, description).read(lens);
}

void write_png_gbuffer(const fs::path& path, const GBuffer& buffer) {
    check_output(path);
    json description = {{"camera", camera_json(buffer.camera)}};
    const auto write = [&](const char* name, int channels, const auto& value, json entry) {
        const fs::path file = path.stem().string() + "-" + name + ".png";
        PngChannels picture{buffer.width, buffer.height, channels, {}};
        for (std::size_t i = 0; i < buffer.pixels(); ++i)
            for (int c = 0; c < channels; ++c) picture.values.push_back(value(i, c));
        write_png_channels(path.parent_path() / file, picture);
        entry["file"] = uri_of_relative_path(file);
        description[name] = std::move(entry);
    };

    float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
    for (const float depth : buffer.depth)
        if (is_surface(depth)) nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
    if (!(nearest <= farthest)) nearest = 0, farthest = 1;
    // 65535 is sky: what is there ends one step before it.
    const float from = nearest,
                to = nearest + std::max(farthest - nearest, 1e-6f * farthest) * kMost / (kMost - 1);
    write("depth", 1,
          [&](std::size_t i, int) {
              return is_surface(buffer.depth[i])
                         ? std::min<std::uint16_t>(coded((buffer.depth[i] - from) / (to - from)), 0xfffe)
                         : std::uint16_t{0xffff};
          },
          {{"encoding", "linear"}, {"from", from}, {"to", to}});
    if (!buffer.normals.empty())
        write(
            "normals", 3, [&](std::size_t i, int c) { return coded(0.5f * buffer.normals[i][c] + 0.5f); },
            json::object());
    const auto write_scaled = [&](const char* name, const std::vector<glm::vec3>& values) {
        if (values.empty()) return;
        float most = 1;
        for (const glm::vec3& value : values)
            for (int c = 0; c < 3; ++c)
                if (std::isfinite(value[c])) most = std::max(most, value[c]);
        write(name, 3, [&](std::size_t i, int c) { return coded(values[i][c] / most); }, {{"scale", most}});
    };
    write_scaled("albedo", buffer.albedo);
    write_scaled("radiance", buffer.radiance);
    write_file_atomic(path, description.dump(2) + "\n");
}

}  // namespace dfield
