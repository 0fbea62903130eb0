#include <cmath>
#include <glm/geometric.hpp>

#include "baker/error.hpp"
#include "baker/import/text_scan.hpp"
#include "baker/screen/gbuffer_formats.hpp"

namespace dfield {
namespace {

using nlohmann::json;

bool ends_in(const std::filesystem::path& path, std::string_view extension) {
    return equal_ignoring_case(path.extension().string(), extension);
}

// Numbers of an array of exactly `count`.
std::vector<float> read_array(const std::string& where, const json& object, const char* name,
                              std::size_t count) {
    const json& array = object.at(name);
    if (!array.is_array() || array.size() != count)
        throw InputError(where + ": " + name + " is no array of " + std::to_string(count) + " numbers");
    std::vector<float> numbers;
    for (const json& number : array) {
        numbers.push_back(number.is_number() ? number.get<float>() : NAN);
        if (!std::isfinite(numbers.back()))
            throw InputError(where + ": " + name + " has an entry that is no finite number");
    }
    return numbers;
}

// null is infinity, which JSON has no number for.
float read_plane(const std::string& where, const json& camera, const char* name, float fallback) {
    const auto plane = camera.find(name);
    if (plane == camera.end()) return fallback;
    if (plane->is_null()) return std::numeric_limits<float>::infinity();
    const auto value = static_cast<float>(read_number(where, camera, name, 0));
    if (!(value >= 0)) throw InputError(where + ": " + name + " is below 0");
    return value;
}

glm::mat4 read_pose(const std::string& where, const json& camera) {
    const std::vector<float> numbers = read_array(where, camera, "to_world", 16);
    glm::mat4 pose(1);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            pose[column][row] = numbers[static_cast<std::size_t>(4 * column + row)];
    const glm::mat3 turn(pose), gram = glm::transpose(turn) * turn;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::fabs(gram[i][j] - (i == j ? 1.0f : 0.0f)) < 1e-3f))
                throw InputError(where + ": to_world is no rotation with a translation, column by column");
    if (glm::dot(glm::cross(turn[0], turn[1]), turn[2]) < 0)
        throw InputError(where + ": to_world mirrors; camera space is right-handed, looking along -z");
    return pose;
}

}  // namespace

double read_number(const std::string& where, const json& object, const char* name, double fallback) {
    const auto number = object.find(name);
    if (number == object.end()) return fallback;
    const double value = number->is_number() ? number->get<double>() : NAN;
    if (!(std::fabs(value) < 1e30)) throw InputError(where + ": " + name + " is no finite number");
    return value;
}

json parse_gbuffer_json(const std::string& where, std::string_view text) {
    json description = json::parse(text, nullptr, false);
    if (!description.is_object()) throw InputError(where + ": is no JSON object; see docs/gbuffer.md");
    return description;
}

json camera_json(const ScreenCamera& camera) {
    const auto plane = [](float depth) { return std::isinf(depth) ? json() : json(depth); };
    json matrix = json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix.push_back(camera.to_world[column][row]);
    return {{"projection", camera.orthographic ? "orthographic" : "perspective"},
            {"half_width", camera.half_width},
            {"half_height", camera.half_height},
            {"offset", {camera.offset.x, camera.offset.y}},
            {"near", plane(camera.near)},
            {"far", plane(camera.far)},
            {"to_world", matrix}};
}

ScreenCamera read_camera_json(const std::string& file, const json& description, const ScreenCamera* lens,
                              std::uint32_t width, std::uint32_t height) {
    const auto found = description.find("camera");
    if (found == description.end()) {
        if (!lens)
            throw InputError(file +
                             ": does not say which camera it was seen by; give --fov or --orthographic");
        ScreenCamera camera = *lens;
        camera.half_width = camera.half_height * static_cast<float>(width) / static_cast<float>(height);
        return camera;
    }
    const std::string where = file + ": camera";
    if (!found->is_object()) throw InputError(where + " is no object");
    const json& source = *found;
    ScreenCamera camera;
    const json projection = source.value("projection", json("perspective"));
    if (projection != "perspective" && projection != "orthographic")
        throw InputError(where + ": projection is neither perspective nor orthographic");
    camera.orthographic = projection == "orthographic";
    const auto half = [&](const char* name) {
        const double value = read_number(where, source, name, 0);
        if (!(value > 0)) throw InputError(where + ": " + name + " is missing or not above 0");
        return static_cast<float>(value);
    };
    camera.half_width = half("half_width");
    camera.half_height = half("half_height");
    if (source.contains("offset")) {
        const std::vector<float> offset = read_array(where, source, "offset", 2);
        camera.offset = {offset[0], offset[1]};
    }
    camera.near = read_plane(where, source, "near", camera.near);
    camera.far = read_plane(where, source, "far", camera.far);
    if (camera.near == camera.far) throw InputError(where + ": near and far are the same");
    if (source.contains("to_world")) camera.to_world = read_pose(where, source);
    return camera;
}

bool depth_is_device(const std::string& where, const json& description, const ScreenCamera& camera) {
    const auto depth = description.find("depth");
    if (depth == description.end() || !depth->is_object()) return false;
    const json encoding = depth->value("encoding", json("linear"));
    if (encoding != "linear" && encoding != "device")
        throw InputError(where + ": depth: encoding is neither linear nor device");
    if (encoding != "device") return false;
    if (camera.orthographic ? std::isinf(camera.near) || std::isinf(camera.far)
                            : !(camera.near > 0 && camera.far > 0))
        throw InputError(where + ": depth: device depths need the camera's near and far, " +
                         (camera.orthographic ? "both finite" : "both above 0"));
    return true;
}

void check_picture_size(const std::string& where, std::uint64_t width, std::uint64_t height,
                        std::uint64_t file_bytes) {
    if (width == 0 || height == 0 || width > kMaxScreenSide || height > kMaxScreenSide)
        throw InputError(where + ": " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels; sides are 1 to " + std::to_string(kMaxScreenSide));
    // Deflate, which packs best of what these files use, gains at most a factor of 1032.
    constexpr std::uint64_t kMostGain = 1100, kAlways = std::uint64_t{4} << 20;
    if (width * height > kAlways + kMostGain * file_bytes)
        throw InputError(where + ": claims " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels in " + std::to_string(file_bytes) + " bytes; it is cut off or broken");
}

bool is_gbuffer(const std::filesystem::path& path) {
    return ends_in(path, ".exr") || ends_in(path, ".json");
}

GBuffer read_gbuffer(const std::filesystem::path& path, const ScreenCamera* lens) {
    GBuffer buffer = ends_in(path, ".exr") ? read_exr_gbuffer(path, lens) : read_png_gbuffer(path, lens);
    for (float& depth : buffer.depth)
        if (!is_surface(depth)) depth = std::numeric_limits<float>::infinity();
    return buffer;
}

void write_gbuffer(const std::filesystem::path& path, const GBuffer& buffer) {
    if (ends_in(path, ".exr"))
        write_exr_gbuffer(path, buffer);
    else if (ends_in(path, ".json"))
        write_png_gbuffer(path, buffer);
    else
        throw Error(ExitCode::kUsage, path.string() + ": G-buffers are .exr, or .json with PNGs beside it");
}

}  // namespace dfield
