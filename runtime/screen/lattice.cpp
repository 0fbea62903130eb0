#include "screen/lattice.hpp"

namespace dfield::runtime::screen {

void surround(const Frame& frame, const Lattice& lattice) {
    for (std::int32_t y = 0; y < lattice.side; ++y)
        for (std::int32_t x = 0; x < lattice.side; ++x) {
            float* const picture = lattice.depth + lattice.index(x, y, -Lattice::kBorder, -1);
            const std::int32_t width = (frame.layout.width - x + lattice.side - 1) / lattice.side;
            const std::int32_t height = (frame.layout.height - y + lattice.side - 1) / lattice.side;
            std::fill_n(picture, lattice.stride + Lattice::kBorder, kSky);
            for (std::int32_t row = 0; row < height; ++row) {
                float* const end = lattice.depth + lattice.index(x, y, width, row);
                std::fill(end, lattice.depth + lattice.index(x, y, 0, row + 1), kSky);
            }
            std::fill(lattice.depth + lattice.index(x, y, 0, height), picture + lattice.picture, kSky);
        }
}

void take_apart(const Frame& frame, const Lattice& lattice, std::int32_t row) {
    const Layout& layout = frame.layout;
    const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
    for (std::int32_t column = 0; column < layout.width; ++column) {
        const std::ptrdiff_t to = lattice.index(column % lattice.side, row % lattice.side,
                                                column / lattice.side, row / lattice.side);
        lattice.depth[to] = frame.depth[layout.index(column, row)];
        const glm::vec3 surface = normal_at(frame, column, row);
        const Shaded s = shaded_at(frame, column, row);
        for (int i = 0; i < 3; ++i) lattice.normals[i * plane + to] = s.normal[i];
        if (!lattice.radiance) continue;
        const float* const radiance =
            frame.radiance.at(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
        for (int i = 0; i < 3; ++i) {
            lattice.surfaces[i * plane + to] = surface[i];
            lattice.radiance[i * plane + to] = radiance[i] > 0 ? radiance[i] : 0;
        }
    }
}

}  // namespace dfield::runtime::screen
