#include <array>

#include "screen/filter.hpp"

namespace dfield::runtime::screen {

void filter_reference(const FilterJob& job, std::int32_t row, std::int32_t first, float* out) {
    const Frame& frame = *job.frame;
    const Layout& layout = frame.layout;
    const auto plane = static_cast<std::ptrdiff_t>(layout.size());
    const std::int32_t reach = job.reach();
    for (std::int32_t column = first; column < std::min(layout.width, first + kFilterColumns); ++column) {
        const std::ptrdiff_t at = layout.index(column, row);
        const auto channel = [&](std::int32_t i, std::ptrdiff_t where) {
            return i == 0 ? job.visibility[where] : job.light[(i - 1) * plane + where];
        };
        std::array<float, 5> sum{};
        float total = 0;
        for (std::int32_t y = -reach; y <= reach && frame.depth[at] < kSky; ++y)
            for (std::int32_t x = -reach; x <= reach; ++x) {
                const std::ptrdiff_t there = at + y * layout.stride + x;
                const float tangent = frame.depth[at] + (static_cast<float>(x) * job.slopes[at] +
                                                         static_cast<float>(y) * job.slopes[plane + at]);
                if (!(std::abs(frame.depth[there] - tangent) <= job.limit) && there != at) continue;
                const float weight = job.weight(x) * job.weight(y);
                total += weight;
                for (std::int32_t i = 0; i < job.channels; ++i)
                    sum[static_cast<std::size_t>(i)] += weight * channel(i, there);
            }
        for (std::int32_t i = 0; i < job.channels; ++i)
            out[i * kFilterColumns + column - first] =
                total > 0 ? sum[static_cast<std::size_t>(i)] / total : channel(i, at);
    }
}

}  // namespace dfield::runtime::screen
