#include <algorithm>
#include <array>

#include "screen/filter.hpp"

namespace dfield::runtime::screen {

void filter_reference(const FilterJob& job, std::int32_t row, std::int32_t first,
                      float (*out)[kFilterColumns]) {
    const Frame& frame = *job.frame;
    const Layout& layout = frame.layout;
    const auto plane = static_cast<std::ptrdiff_t>(layout.size());
    const std::int32_t reach = job.reach();
    for (std::int32_t column = first; column < std::min(layout.width, first + kFilterColumns); ++column) {
        const std::ptrdiff_t at = layout.index(column, row);
        float visibility = 0, total = 0;
        std::array<float, 4> light{};
        const auto add = [&](float weight, std::ptrdiff_t there) {
            total += weight;
            visibility += weight * job.visibility[there];
            for (std::size_t i = 0; job.indirect && i < 4; ++i)
                light[i] += weight * job.light[static_cast<std::ptrdiff_t>(i) * plane + there];
        };
        for (std::int32_t y = -reach; y <= reach && frame.depth[at] < kSky; ++y)
            for (std::int32_t x = -reach; x <= reach; ++x) {
                const std::ptrdiff_t there = at + y * layout.stride + x;
                if (there != at) {
                    const float tangent = frame.depth[at] + (static_cast<float>(x) * job.slopes[at] +
                                                             static_cast<float>(y) * job.slopes[plane + at]);
                    if (!(std::abs(frame.depth[there] - tangent) <= job.limit)) continue;
                }
                add(job.weight(x) * job.weight(y), there);
            }
        if (total == 0) add(1, at);
        const std::int32_t i = column - first;
        out[0][i] = visibility / total;
        if (!job.indirect) continue;
        const float share = light[3] > 0 ? std::max(0.0f, 1 - out[0][i]) / light[3] : 0;
        for (std::size_t k = 0; k < 3; ++k) out[1 + k][i] = light[k] * share;
    }
}

void zip_reference(const float* x, const float* y, const float* z, std::int32_t count, float* out) {
    for (std::int32_t i = 0; i < count; ++i) {
        out[3 * i] = x[i];
        out[3 * i + 1] = y[i];
        out[3 * i + 2] = z[i];
    }
}

}  // namespace dfield::runtime::screen
