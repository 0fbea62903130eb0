#include "screen/frame.hpp"

namespace dfield::runtime::screen {
namespace {

glm::vec3 position(const Frame& frame, std::int32_t column, std::int32_t row, float depth) {
    const float scale = frame.camera.perspective ? depth : 1.0f;
    return {frame.camera.at_x(column) * scale, frame.camera.at_y(row) * scale, -depth};
}

// The surface's course from pixel to pixel along a row or a column, from the neighbour that differs less. At
// the depth of the pixel itself where both are sky.
glm::vec3 course(const Frame& frame, std::int32_t column, std::int32_t row, std::int32_t right,
                 std::int32_t down) {
    const float* const at = frame.depth + frame.layout.index(column, row);
    const std::ptrdiff_t next = right + down * frame.layout.stride;
    const glm::vec3 here = position(frame, column, row, *at);
    const float ahead = std::abs(at[next] - *at), behind = std::abs(at[-next] - *at);
    if (ahead <= behind)
        return position(frame, column + right, row + down, ahead < kSky ? at[next] : *at) - here;
    return here - position(frame, column - right, row - down, at[-next]);
}

}  // namespace

glm::vec3 normal_at(const Frame& frame, std::int32_t column, std::int32_t row) {
    if (frame.normals) {
        const float* const n =
            frame.normals.at(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
        const float squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (squared > 0 && squared < kSky) {
            const float inverse = 1 / std::sqrt(squared);
            return {n[0] * inverse, n[1] * inverse, n[2] * inverse};
        }
    }
    const glm::vec3 across = course(frame, column, row, 1, 0), down = course(frame, column, row, 0, 1);
    const glm::vec3 normal = glm::cross(down, across);
    const float length = glm::length(normal);
    return length > 0 && length < kSky ? normal / length : glm::vec3(0, 0, 1);
}

void decode_depth(const dfield_context& context, const Frame& frame, float* depth) {
    const Layout& layout = frame.layout;
    std::fill_n(depth, layout.index(0, 0), kSky);
    context.for_ranges(static_cast<std::size_t>(layout.height), [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            float* const out = depth + layout.index(0, static_cast<std::ptrdiff_t>(row));
            const auto width = static_cast<std::size_t>(layout.width);
            if (frame.depths.packed(1) && !frame.decode.device) {  // a loop that compilers vectorise
                const float* const in = frame.depths.at(0, row);
                for (std::size_t i = 0; i < width; ++i) out[i] = in[i] > 0 && in[i] < kSky ? in[i] : kSky;
            } else {
                for (std::size_t i = 0; i < width; ++i) out[i] = frame.decode(*frame.depths.at(i, row));
            }
            std::fill(out + layout.width, out + layout.stride, kSky);  // the next row's left border too
        }
    });
    const std::ptrdiff_t end = layout.index(0, layout.height);
    std::fill(depth + end, depth + layout.size(), kSky);
}

}  // namespace dfield::runtime::screen
