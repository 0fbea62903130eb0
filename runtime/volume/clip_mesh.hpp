// A closed mesh that clips volumes: depth layers seen by a camera that is fixed to it (section 3.2 of the
// paper), or exact inside tests where two layers do not tell all.
#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory_resource>
#include <span>
#include <vector>

#include "context.hpp"
#include "dfield/contextual.h"

namespace dfield::runtime::volume {

// Points of the clipping camera: x, y across its picture, z along its orthographic view, in the mesh's own
// unit.
using CameraPoint = glm::dvec3;

// As exact as the mesh's vertices; both depths in one load.
struct alignas(8) DepthPixel {
    float front =
        std::numeric_limits<float>::infinity();  // inverted where there is no mesh: nothing is inside
    float back = -std::numeric_limits<float>::infinity();

    bool between(double depth) const {
        return depth > static_cast<double>(front) && depth < static_cast<double>(back);
    }
};

// Z_front and Z_back: pixel (i, j) looks along the line through low + (i + 1/2, j + 1/2) * pixel.
struct DepthMaps {
    glm::dvec2 low{0};
    double pixel = 1, per_pixel = 1;  // a pixel's side, and 1 over it
    std::int32_t width = 0, height = 0;
    std::pmr::vector<DepthPixel> pixels;

    // Which pixel a point is in; nullptr beyond the maps.
    const DepthPixel* at(const CameraPoint& p) const {
        const double x = (p.x - low.x) * per_pixel, y = (p.y - low.y) * per_pixel;
        if (!(x >= 0 && y >= 0 && x < width && y < height)) return nullptr;
        return &pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)];
    }
};

}  // namespace dfield::runtime::volume

struct dfield_clip_mesh final : dfield::runtime::Shared<dfield_clip_mesh> {
    using CameraPoint = dfield::runtime::volume::CameraPoint;

    // Throws Failure where the mesh is not closed, or the description makes no sense.
    dfield_clip_mesh(dfield_context* context, const dfield_clip_mesh_desc& desc);

    // The camera looks along this axis of the mesh; its x and y are the two axes after it.
    int axis() const { return axis_; }
    CameraPoint to_camera(const glm::dvec3& p) const {
        return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3], p[axis_]};
    }
    bool exact() const { return exact_; }
    std::uint32_t layers() const { return layers_; }
    const dfield::runtime::volume::DepthMaps& maps() const { return maps_; }
    const CameraPoint& low() const { return low_; }
    const CameraPoint& high() const { return high_; }

    // Equation 1, turned round: strictly between the layers; or by how often the mesh winds around the point.
    bool inside(const CameraPoint& p) const {
        if (exact_) return inside_exactly(p);
        const auto* const pixel = maps_.at(p);
        return pixel && pixel->between(p.z);
    }

    // What is known of all points of a box.
    enum class Side : std::uint8_t { kOutside, kInside, kMixed };
    Side side(const CameraPoint& centre, const glm::dvec3& half_size) const;

  private:
    struct Corner {
        std::uint32_t vertex[3];
    };
    // Where a line along z meets a triangle: its depth and +-1 for the side, or false.
    bool crossing(const Corner& triangle, double x, double y, double& depth, int& sign) const;
    void weld(const dfield_clip_mesh_desc& desc);
    void check_closed();
    void look_along(int axis);  // turns `points_` and sets the bounds
    void rasterise(std::int32_t resolution);
    void sort_triangles();
    void make_cells();
    bool touches(const Corner& triangle, const CameraPoint& centre, double half) const;
    bool inside_exactly(const CameraPoint& p) const;

    std::pmr::vector<CameraPoint> points_;
    std::pmr::vector<Corner> triangles_;
    bool oriented_ = true, exact_ = false;
    int axis_ = 2;
    std::uint32_t layers_ = 0;
    CameraPoint low_{0}, high_{0};
    dfield::runtime::volume::DepthMaps maps_;

    // Triangles by squares of the picture.
    double square_ = 1;
    std::int32_t squares_x_ = 0, squares_y_ = 0;
    std::pmr::vector<std::uint32_t> first_, sorted_;

    // Cells of the bounds, with one more all round: which side they are on, and how many cells lie between
    // them and the nearest one that the boundary passes, counted along the axis where most do.
    double cell_ = 1;
    std::int32_t cells_[3] = {0, 0, 0};
    struct Cell {
        Side side;
        std::uint8_t clearance;
    };
    std::pmr::vector<Cell> cell_sides_;
};
