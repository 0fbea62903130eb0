#include "screen/checks.hpp"

#include "desc.hpp"
#include "status.hpp"

namespace dfield::runtime::screen {
namespace {

constexpr const char* kVersion =
    "screen: a struct_size is of no known version; header and library are of different versions, or the "
    "field was "
    "not set";

bool positive(float value) {
    return std::isfinite(value) && value > 0;
}

void check_camera(const dfield_screen_camera& camera, std::uint32_t encoding) {
    require(camera.projection <= DFIELD_PROJECTION_ORTHOGRAPHIC, "screen: unknown projection");
    require(positive(camera.half_width) && positive(camera.half_height),
            "screen: the camera's half_width and half_height must be finite and above 0");
    require(std::isfinite(camera.offset_x) && std::isfinite(camera.offset_y),
            "screen: the camera's offset_x and offset_y must be finite");
    require(encoding <= DFIELD_DEPTH_DEVICE, "screen: unknown depth_encoding");
    if (encoding == DFIELD_DEPTH_DISTANCE) return;
    const float near = camera.near_plane, far = camera.far_plane;
    require(near >= 0 && far >= 0 && near != far,
            "screen: device depths need the camera's near_plane and far_plane, not negative and not equal");
    if (camera.projection == DFIELD_PROJECTION_PERSPECTIVE)
        require(near > 0 && far > 0, "screen: near_plane and far_plane of a perspective must be above 0");
    else
        require(std::isfinite(near) && std::isfinite(far),
                "screen: near_plane and far_plane of an orthographic camera must be finite");
}

template<class Plane>
void check_strides(const Plane& plane, std::uint32_t width, std::ptrdiff_t values, const char* message) {
    if (!plane.data) return;
    const std::ptrdiff_t pixel = plane.pixel_stride ? plane.pixel_stride : 4 * values;
    require(pixel % 4 == 0 && plane.row_stride % 4 == 0 && pixel >= 4 * values, message);
    constexpr std::ptrdiff_t kMost = PTRDIFF_MAX / DFIELD_MAX_SCREEN_DIM / 4;
    require(pixel <= kMost && plane.row_stride <= kMost && plane.row_stride >= -kMost, message);
    const std::ptrdiff_t row = plane.row_stride < 0 ? -plane.row_stride : plane.row_stride;
    require(row == 0 || row >= pixel * static_cast<std::ptrdiff_t>(width - 1) + 4 * values, message);
}

}  // namespace

void check_target(const dfield_screen_target& target, std::uint32_t width, const char* message) {
    check_strides(target, width, 3, message);
}

dfield_screen_desc checked_desc(const dfield_screen_desc* given) {
    require(given, "screen: desc is null");
    const auto desc = read_desc(given, {}, kVersion);
    require(desc.estimator <= DFIELD_ESTIMATOR_MARCH, "screen: unknown estimator");
    require(desc.measure <= DFIELD_MEASURE_EXPONENTIAL, "screen: unknown measure");
    require(
        std::isfinite(desc.radius) && (desc.radius == 0 || (desc.radius >= 1e-18f && desc.radius <= 1e18f)),
        "screen: radius must be 0 or 1e-18..1e18");
    require(desc.measure != DFIELD_MEASURE_EXPONENTIAL || positive(desc.sigma),
            "screen: EXPONENTIAL needs a sigma that is finite and above 0");
    require(desc.samples >= 1 && desc.samples <= DFIELD_MAX_SCREEN_SAMPLES,
            "screen: samples must be 1..4096");
    require(desc.estimator != DFIELD_ESTIMATOR_MARCH ||
                (desc.march_steps >= 1 && desc.march_steps <= DFIELD_MAX_SCREEN_SAMPLES),
            "screen: march_steps must be 1..4096");
    require(desc.interleave >= 1 && desc.interleave <= 8, "screen: interleave must be 1..8");
    require(desc.filter == 0 || positive(desc.filter_limit),
            "screen: filter_limit must be finite and above 0");
    require(desc.sight <= DFIELD_SIGHT_AXIS, "screen: unknown sight");
    require(desc.weights <= DFIELD_WEIGHTS_PLAIN, "screen: unknown weights");
    for (const float ambient : desc.ambient)
        require(std::isfinite(ambient) && ambient >= 0, "screen: ambient must be finite and not negative");
    return desc;
}

dfield_screen_buffers checked_buffers(const dfield_screen_buffers* given) {
    require(given, "screen: buffers is null");
    const auto buffers = read_desc(given, {}, kVersion);
    require(buffers.width >= 1 && buffers.width <= DFIELD_MAX_SCREEN_DIM && buffers.height >= 1 &&
                buffers.height <= DFIELD_MAX_SCREEN_DIM,
            "screen: width and height must be 1..16384");
    check_camera(buffers.camera, buffers.depth_encoding);
    require(buffers.depth.data, "screen: depth is null");
    check_strides(buffers.depth, buffers.width, 1,
                  "screen: depth's strides must be multiples of 4 that hold a row");
    check_strides(buffers.normals, buffers.width, 3,
                  "screen: the normals' strides must be multiples of 4 that hold a row");
    check_strides(buffers.radiance, buffers.width, 3,
                  "screen: radiance's strides must be multiples of 4 that hold a row");
    check_strides(buffers.albedo, buffers.width, 3,
                  "screen: albedo's strides must be multiples of 4 that hold a row");
    return buffers;
}

dfield_screen_outputs checked_outputs(const dfield_screen_outputs* given,
                                      const dfield_screen_buffers& buffers) {
    require(given, "screen: outputs is null");
    const auto outputs = read_desc(given, {}, kVersion);
    check_strides(outputs.visibility, buffers.width, 1,
                  "screen: visibility's strides must be multiples of 4 that hold a row");
    check_target(outputs.indirect, buffers.width,
                 "screen: indirect's strides must be multiples of 4 that hold a row");
    check_target(outputs.reflected, buffers.width,
                 "screen: reflected's strides must be multiples of 4 that hold a row");
    require(!outputs.indirect.data || buffers.radiance.data, "screen: indirect light needs radiance");
    return outputs;
}

Frame frame_of(const dfield_screen_buffers& buffers, float radius, std::uint32_t sight) {
    const auto pixels = [&](const dfield_screen_plane& plane, std::ptrdiff_t values) {
        return StridedPixels<const float>(plane.data, plane.pixel_stride, plane.row_stride, buffers.width,
                                          values);
    };
    Frame frame;
    frame.layout = Layout(buffers.width, buffers.height);
    frame.camera = Camera(buffers.camera, buffers.width, buffers.height);
    if (frame.camera.perspective && sight == DFIELD_SIGHT_VIEW) frame.sight = frame.camera;
    frame.radius = radius;
    frame.per_radius = radius > 0 ? 1 / radius : 0;
    frame.decode = DepthDecoder(buffers.camera, buffers.depth_encoding);
    frame.depths = pixels(buffers.depth, 1);
    frame.normals = pixels(buffers.normals, 3);
    frame.radiance = pixels(buffers.radiance, 3);
    frame.albedo = pixels(buffers.albedo, 3);
    return frame;
}

}  // namespace dfield::runtime::screen
