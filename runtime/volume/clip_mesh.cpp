#include "volume/clip_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "status.hpp"
#include "strided.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

dfield_clip_mesh::dfield_clip_mesh(dfield_context* context, const dfield_clip_mesh_desc& desc)
    : Shared(context),
      points_(context),
      triangles_(context),
      maps_{glm::dvec2(0), 1, 1, 0, 0, std::pmr::vector<DepthPixel>(context)},
      first_(context),
      sorted_(context),
      cell_sides_(context) {
    weld(desc);
    check_closed();
    const auto resolution = static_cast<std::int32_t>(desc.resolution);
    exact_ = desc.method == DFIELD_CLIP_EXACT;
    if (exact_) {
        look_along(2);
    } else if (desc.method == DFIELD_CLIP_DEPTH_MAPS) {
        look_along(static_cast<int>(desc.axis));
        rasterise(resolution);
    } else {
        // The axis that shows two layers everywhere, if there is one.
        for (const int axis : {2, 0, 1}) {
            look_along(axis);
            rasterise(resolution);
            if (layers_ <= 2) break;
        }
        exact_ = layers_ > 2;
    }
    if (exact_) {
        maps_.pixels.clear();
        maps_.pixels.shrink_to_fit();
        sort_triangles();
    } else {
        // Pixels reach beyond the mesh, and so does rounding: of depths, and of which pixel a point is in.
        const double rounding = 1e-9 * maps_.pixel;
        high_.x = maps_.low.x + maps_.width * maps_.pixel + rounding;
        high_.y = maps_.low.y + maps_.height * maps_.pixel + rounding;
        low_ -= rounding;
        high_.z += rounding;
    }
    make_cells();
}

// Vertices at one place become one, whatever split them (normals, texture coordinates); triangles without an
// area go.
void dfield_clip_mesh::weld(const dfield_clip_mesh_desc& desc) {
    const Strided<const float> positions(desc.positions, desc.position_stride, 3);
    std::pmr::vector<std::uint32_t> order(desc.vertex_count, context()), welded(desc.vertex_count, context());
    std::iota(order.begin(), order.end(), 0u);
    float largest = 0;
    for (std::uint32_t i = 0; i < desc.vertex_count; ++i) {
        const glm::vec3 p = positions.vec3(i);
        require(finite(p), "dfield_clip_mesh_create: a vertex is not finite");
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    // One place is so near: poles of spheres and the like are one vertex but for rounding.
    const float place = largest * 0x1p-21f;
    const auto key = [&](std::uint32_t i) {
        const glm::vec3 p = glm::round(positions.vec3(i) / place) + 0.0f;  // -0 and 0 are one place
        return std::array<float, 3>{p.x, p.y, p.z};
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || key(order[i]) != key(order[i - 1])) points_.emplace_back(positions.vec3(order[i]));
        welded[order[i]] = static_cast<std::uint32_t>(points_.size() - 1);
    }
    for (std::size_t i = 0; i < desc.triangle_count; ++i) {
        Corner corner;
        for (std::size_t j = 0; j < 3; ++j) {
            const std::uint32_t index = desc.indices[3 * i + j];
            require(index < desc.vertex_count, "dfield_clip_mesh_create: an index is not below vertex_count");
            corner.vertex[j] = welded[index];
        }
        const auto& [a, b, c] = corner.vertex;
        if (a != b && b != c && c != a) triangles_.push_back(corner);
    }
    require(!triangles_.empty(), "dfield_clip_mesh_create: no triangle has an area");
}

// Each edge of a closed mesh is met by as many triangles one way as the other; where triangles are not
// oriented alike, by an even number.
void dfield_clip_mesh::check_closed() {
    struct Edge {
        std::uint32_t low, high;
        int way;
    };
    std::pmr::vector<Edge> edges(context());
    for (const Corner& t : triangles_)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::uint32_t a = t.vertex[j], b = t.vertex[(j + 1) % 3];
            edges.push_back(a < b ? Edge{a, b, 1} : Edge{b, a, -1});
        }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
    for (std::size_t i = 0; i < edges.size();) {
        int balance = 0, count = 0;
        const Edge& edge = edges[i];
        for (; i < edges.size() && edges[i].low == edge.low && edges[i].high == edge.high; ++i, ++count)
            balance += edges[i].way;
        require(
            count % 2 == 0,
            "dfield_clip_mesh_create: the mesh is not closed: an edge belongs to one triangle only, or to an "
            "odd number of them; fill its holes");
        if (balance != 0) oriented_ = false;
    }
}

void dfield_clip_mesh::look_along(int axis) {
    // From the present camera back to the mesh's axes, and on to the new one.
    for (CameraPoint& p : points_) {
        glm::dvec3 mesh;
        mesh[(axis_ + 1) % 3] = p.x;
        mesh[(axis_ + 2) % 3] = p.y;
        mesh[axis_] = p.z;
        p = {mesh[(axis + 1) % 3], mesh[(axis + 2) % 3], mesh[axis]};
    }
    axis_ = axis;
    low_ = high_ = points_.front();
    for (const CameraPoint& p : points_) {
        low_ = glm::min(low_, p);
        high_ = glm::max(high_, p);
    }
    require(low_.x < high_.x && low_.y < high_.y && low_.z < high_.z,
            "dfield_clip_mesh_create: the mesh is flat");
}

bool dfield_clip_mesh::crossing(const Corner& triangle, double x, double y, double& depth, int& sign) const {
    // Which side of an edge, as if (x, y) lay a little towards +x and far less towards +y: no line meets an
    // edge or a vertex. Both triangles of an edge take its ends in the same order, so rounding cannot open a
    // gap.
    double area[3];
    int ways = 0;
    for (std::size_t j = 0; j < 3; ++j) {
        std::uint32_t a = triangle.vertex[(j + 1) % 3], b = triangle.vertex[(j + 2) % 3];
        const bool swapped = a > b;
        if (swapped) std::swap(a, b);
        const CameraPoint &p = points_[a], &q = points_[b];
        double side = (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
        bool positive = side > 0;
        if (side == 0) positive = q.y != p.y ? q.y < p.y : q.x > p.x;
        if (swapped) {
            side = -side;
            positive = !positive;
        }
        area[j] = side;
        ways += positive ? 1 : -1;
    }
    if (ways != 3 && ways != -3) return false;
    sign = ways / 3;
    const CameraPoint &a = points_[triangle.vertex[0]], &b = points_[triangle.vertex[1]],
                      &c = points_[triangle.vertex[2]];
    const double all = area[0] + area[1] + area[2];
    depth = all != 0 ? (area[0] * a.z + area[1] * b.z + area[2] * c.z) / all : a.z;
    return true;
}

void dfield_clip_mesh::rasterise(std::int32_t resolution) {
    maps_.pixel = std::max(high_.x - low_.x, high_.y - low_.y) / resolution;
    maps_.per_pixel = 1 / maps_.pixel;
    maps_.low = {low_.x, low_.y};
    const auto pixels = [&](double length) {
        return std::max(1, static_cast<std::int32_t>(std::ceil(length / maps_.pixel - 1e-9)));
    };
    maps_.width = pixels(high_.x - low_.x);
    maps_.height = pixels(high_.y - low_.y);
    const auto size = static_cast<std::size_t>(maps_.width) * static_cast<std::size_t>(maps_.height);
    maps_.pixels.assign(size, DepthPixel{});
    std::pmr::vector<std::uint32_t> crossings(size, 0, context());
    for (const Corner& t : triangles_) {
        glm::dvec2 low(points_[t.vertex[0]]), high = low;
        for (const std::uint32_t v : t.vertex) {
            low = glm::min(low, glm::dvec2(points_[v]));
            high = glm::max(high, glm::dvec2(points_[v]));
        }
        const glm::dvec2 first = (low - maps_.low) / maps_.pixel, last = (high - maps_.low) / maps_.pixel;
        const auto i0 = std::max(0, static_cast<std::int32_t>(first.x - 1)),
                   i1 = std::min(maps_.width - 1, static_cast<std::int32_t>(last.x + 1)),
                   j0 = std::max(0, static_cast<std::int32_t>(first.y - 1)),
                   j1 = std::min(maps_.height - 1, static_cast<std::int32_t>(last.y + 1));
        for (std::int32_t j = j0; j <= j1; ++j)
            for (std::int32_t i = i0; i <= i1; ++i) {
                double depth;
                int sign;
                if (!crossing(t, maps_.low.x + (i + 0.5) * maps_.pixel, maps_.low.y + (j + 0.5) * maps_.pixel,
                              depth, sign))
                    continue;
                const auto at = static_cast<std::size_t>(j) * static_cast<std::size_t>(maps_.width) +
                                static_cast<std::size_t>(i);
                DepthPixel& pixel = maps_.pixels[at];
                pixel.front = std::min(pixel.front, static_cast<float>(depth));
                pixel.back = std::max(pixel.back, static_cast<float>(depth));
                ++crossings[at];
            }
    }
    layers_ = *std::max_element(crossings.begin(), crossings.end());
}

void dfield_clip_mesh::sort_triangles() {
    const double extent = std::max(high_.x - low_.x, high_.y - low_.y);
    const auto across = static_cast<std::int32_t>(
        std::clamp(std::sqrt(static_cast<double>(triangles_.size())) * 2, 8.0, 512.0));
    square_ = extent / across;
    squares_x_ = static_cast<std::int32_t>((high_.x - low_.x) / square_) + 1;
    squares_y_ = static_cast<std::int32_t>((high_.y - low_.y) / square_) + 1;
    first_.assign(static_cast<std::size_t>(squares_x_) * static_cast<std::size_t>(squares_y_) + 1, 0);
    const auto for_squares = [&](const Corner& t, const auto& use) {
        std::int32_t box[2][2] = {{squares_x_, squares_y_}, {0, 0}};
        for (const std::uint32_t v : t.vertex)
            for (int axis = 0; axis < 2; ++axis) {
                const auto at = static_cast<std::int32_t>((points_[v][axis] - low_[axis]) / square_);
                box[0][axis] = std::min(box[0][axis], at);
                box[1][axis] = std::max(box[1][axis], at);
            }
        for (std::int32_t y = box[0][1]; y <= box[1][1]; ++y)
            for (std::int32_t x = box[0][0]; x <= box[1][0]; ++x)
                use(static_cast<std::size_t>(y) * static_cast<std::size_t>(squares_x_) +
                    static_cast<std::size_t>(x));
    };
    for (const Corner& t : triangles_) for_squares(t, [&](std::size_t square) { ++first_[square + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    sorted_.resize(first_.back());
    std::pmr::vector<std::uint32_t> next(first_.begin(), first_.end() - 1, context());
    for (std::uint32_t i = 0; i < triangles_.size(); ++i)
        for_squares(triangles_[i], [&](std::size_t square) { sorted_[next[square]++] = i; });
}

bool dfield_clip_mesh::inside_exactly(const CameraPoint& p) const {
    for (int axis = 0; axis < 3; ++axis)
        if (!(p[axis] >= low_[axis] && p[axis] <= high_[axis])) return false;
    const auto x = static_cast<std::size_t>((p.x - low_.x) / square_),
               y = static_cast<std::size_t>((p.y - low_.y) / square_),
               square = y * static_cast<std::size_t>(squares_x_) + x;
    int winding = 0, before = 0;
    for (std::uint32_t i = first_[square]; i < first_[square + 1]; ++i) {
        double depth;
        int sign;
        if (!crossing(triangles_[sorted_[i]], p.x, p.y, depth, sign) || depth >= p.z) continue;
        winding += sign;
        ++before;
    }
    return oriented_ ? winding != 0 : before % 2 != 0;
}
