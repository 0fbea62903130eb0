#include "baker/volume/render_volume.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>
#include <stdexcept>

namespace dfield {
namespace {

// Trilinear samples at positions in voxels, clamped to the grid.
class Trilinear {
  public:
    Trilinear(const VolumeGrid& grid, std::span<const float> values) : values_(values.data()) {
        if (values.size() != grid.voxels())
            throw std::invalid_argument("volume picture: as many values as the grid has voxels");
        for (int axis = 0; axis < 3; ++axis) {
            const auto size = static_cast<std::ptrdiff_t>(grid.size[static_cast<std::size_t>(axis)]);
            last_[axis] = static_cast<float>(size - 1);
            last_cell_[axis] = std::max<std::ptrdiff_t>(size - 2, 0);
        }
        stride_[0] = 1;
        stride_[1] = static_cast<std::ptrdiff_t>(grid.size[0]);
        stride_[2] = stride_[1] * static_cast<std::ptrdiff_t>(grid.size[1]);
        for (int axis = 0; axis < 3; ++axis) next_[axis] = last_[axis] > 0 ? stride_[axis] : 0;
    }

    float operator()(const glm::vec3& index) const {
        const glm::vec3 p = glm::clamp(index, glm::vec3(0), last_);
        std::ptrdiff_t at = 0;
        glm::vec3 f;
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = std::min(static_cast<std::ptrdiff_t>(p[axis]), last_cell_[axis]);
            f[axis] = p[axis] - static_cast<float>(cell);
            at += cell * stride_[axis];
        }
        const auto along_x = [&](const float* v) { return v[0] + f.x * (v[next_[0]] - v[0]); };
        const auto along_y = [&](const float* v) {
            const float low = along_x(v);
            return low + f.y * (along_x(v + next_[1]) - low);
        };
        const float low = along_y(values_ + at);
        return low + f.z * (along_y(values_ + at + next_[2]) - low);
    }

    // Per voxel, by central differences.
    glm::vec3 gradient(const glm::vec3& index) const {
        glm::vec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 low = index, high = index;
            low[axis] = std::max(index[axis] - 1, 0.0f);
            high[axis] = std::min(index[axis] + 1, last_[axis]);
            const float width = high[axis] - low[axis];
            gradient[axis] = width > 0 ? ((*this)(high) - (*this)(low)) / width : 0.0f;
        }
        return gradient;
    }

    const glm::vec3& last() const { return last_; }

  private:
    const float* values_;
    glm::vec3 last_;
    std::ptrdiff_t last_cell_[3], stride_[3], next_[3];
};

// A ray by length in world units, seen in voxels.
struct GridRay {
    glm::vec3 origin, direction;  // in voxels; the direction is a world unit's
    glm::vec3 world_direction;    // unit
    float begin = 0, end = 0;     // what lies within the grid
    glm::vec3 face{0};  // per voxel, outwards: the face of the grid through which the ray came in, if it did

    glm::vec3 at(float t) const { return origin + t * direction; }
};

class GridFrame {
  public:
    explicit GridFrame(const VolumeGrid& grid)
        : to_world_(grid.directions),
          to_index_(glm::inverse(grid.directions)),
          origin_(grid.origin),
          smallest_(0) {
        const glm::dvec3 spacing = grid.spacing();
        smallest_ = static_cast<float>(std::min({spacing.x, spacing.y, spacing.z}));
        if (!(smallest_ > 0) || !std::isfinite(glm::determinant(to_index_)))
            throw std::invalid_argument("volume picture: a grid without extent");
    }

    float smallest_spacing() const { return smallest_; }
    glm::vec3 position(const glm::vec3& index) const {
        return glm::vec3(origin_ + to_world_ * glm::dvec3(index));
    }

    // The part of the ray ahead of its origin that lies between the outermost voxels.
    std::optional<GridRay> enter(const glm::vec3& origin, const glm::vec3& direction,
                                 const glm::vec3& last) const {
        const glm::dvec3 unit = glm::normalize(glm::dvec3(direction));
        const glm::dvec3 from = to_index_ * (glm::dvec3(origin) - origin_), along = to_index_ * unit;
        double begin = 0, end = std::numeric_limits<double>::infinity();
        glm::vec3 face(0);
        for (int axis = 0; axis < 3; ++axis) {
            if (along[axis] == 0) {
                if (from[axis] < 0 || from[axis] > last[axis]) return std::nullopt;
                continue;
            }
            const double a = -from[axis] / along[axis], b = (last[axis] - from[axis]) / along[axis];
            if (std::min(a, b) > begin) {
                begin = std::min(a, b);
                face = glm::vec3(0);
                face[axis] = along[axis] > 0 ? -1.0f : 1.0f;
            }
            end = std::min(end, std::max(a, b));
        }
        if (!(begin < end)) return std::nullopt;
        // From the entry on, so that floats keep their digits however far the eye is.
        return GridRay{glm::vec3(from + begin * along),
                       glm::vec3(along),
                       glm::vec3(unit),
                       0,
                       static_cast<float>(end - begin),
                       face};
    }

    // A gradient per voxel as a unit vector of the world; 0 where it is 0.
    glm::vec3 normal(const glm::vec3& gradient) const {
        const glm::dvec3 world = glm::transpose(to_index_) * glm::dvec3(gradient);
        const double length = glm::length(world);
        return length > 0 ? glm::vec3(world / length) : glm::vec3(0);
    }

    // One voxel along a world direction: as long as the grid's step in the direction in which it goes
    // furthest.
    glm::vec3 voxel_along(const glm::vec3& world_direction) const {
        const glm::vec3 index(to_index_ * glm::dvec3(world_direction));
        const float longest = std::max({std::abs(index.x), std::abs(index.y), std::abs(index.z)});
        return longest > 0 ? index / longest : index;
    }

  private:
    glm::dmat3 to_world_, to_index_;
    glm::dvec3 origin_;
    float smallest_;
};

glm::vec3 light_of(const glm::vec3& light, const glm::vec3& view_direction) {
    return light == glm::vec3(0) ? -view_direction : glm::normalize(light);
}

std::optional<Trilinear> visibility_of(const VolumeGrid& grid, std::span<const float> visibility) {
    if (visibility.empty()) return std::nullopt;
    return Trilinear(grid, visibility);
}

// Where the distance falls to 0, or nothing.
std::optional<float> find_surface(const Trilinear& distance, const GridRay& ray, float voxel) {
    float before = ray.begin;
    float d = distance(ray.at(before));
    if (d <= 0) return before;
    for (float t = before; t < ray.end;) {
        t = std::min(ray.end, t + std::max(0.8f * d, 0.2f * voxel));
        d = distance(ray.at(t));
        if (d <= 0) {
            float inside = t;
            while (inside - before > 1e-3f * voxel) {
                const float middle = 0.5f * (before + inside);
                if (!(middle > before && middle < inside)) break;
                (distance(ray.at(middle)) <= 0 ? inside : before) = middle;
            }
            return 0.5f * (before + inside);
        }
        before = t;
    }
    return std::nullopt;
}

// Half a voxel off the surface, so that it does not hide the light from itself.
bool in_shadow(const GridFrame& frame, const Trilinear& distance, const glm::vec3& index,
               const glm::vec3& normal, const glm::vec3& light) {
    const glm::vec3 off = index + 0.5f * frame.voxel_along(normal);
    const auto ray = frame.enter(frame.position(off), light, distance.last());
    return ray && find_surface(distance, *ray, frame.smallest_spacing());
}

}  // namespace

Camera frame_volume(const VolumeGrid& grid, const glm::vec3& direction_to_eye, const glm::vec3& up,
                    float fov_degrees, float aspect) {
    Bounds bounds{glm::vec3(std::numeric_limits<float>::infinity()),
                  glm::vec3(-std::numeric_limits<float>::infinity())};
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec3 index;
        for (int axis = 0; axis < 3; ++axis)
            index[axis] = (corner >> axis & 1) != 0
                              ? static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1)
                              : 0.0;
        const glm::vec3 position(grid.position(index));
        bounds.min = glm::min(bounds.min, position);
        bounds.max = glm::max(bounds.max, position);
    }
    return frame_bounds(bounds, direction_to_eye, up, fov_degrees, aspect);
}

Image render_isosurface(const ScalarField& field, const Camera& camera, const IsosurfaceStyle& style,
                        const RenderOptions& options) {
    const GridFrame frame(field.grid);
    const Trilinear distance(field.grid, field.values);
    const std::optional<Trilinear> visibility = visibility_of(field.grid, style.visibility);
    const auto colour = [&](const glm::vec3& origin, const glm::vec3& direction) -> std::optional<glm::vec3> {
        const auto ray = frame.enter(origin, direction, distance.last());
        if (!ray) return std::nullopt;
        const auto hit = find_surface(distance, *ray, frame.smallest_spacing());
        if (!hit) return std::nullopt;
        const glm::vec3 index = ray->at(*hit);
        const bool cut = *hit == ray->begin;
        const glm::vec3 normal = !cut                        ? frame.normal(distance.gradient(index))
                                 : ray->face != glm::vec3(0) ? frame.normal(ray->face)
                                                             : -ray->world_direction;
        // The grid's border cuts the matter open to what is outside, which hides nothing.
        const bool open = cut && ray->face != glm::vec3(0);
        float seen = 1;
        if (!open && style.visibility_at)
            seen = style.visibility_at(index);
        else if (!open && visibility)
            seen = (*visibility)(index + style.visibility_offset * frame.voxel_along(normal));
        seen = std::clamp(seen, 0.0f, 1.0f);
        float lit = 1;
        if (style.local) {
            const glm::vec3 light = light_of(style.light, ray->world_direction);
            lit = std::max(0.0f, glm::dot(normal, light));
            if (style.hard_shadows && lit > 0 && in_shadow(frame, distance, index, normal, light)) lit = 0;
        }
        const float direct = (1 - style.ambient) * lit;
        const float grey = style.shadows ? style.ambient + direct * seen
                           : style.local ? (style.ambient + direct) * seen
                                         : seen;
        return grey * style.albedo;
    };
    return render_rays(camera, options, colour);
}

Image render_volume(const ScalarField& field, const TransferFunction& transfer, const Camera& camera,
                    const VolumeStyle& style, const RenderOptions& options) {
    constexpr float kOpaque = 1e-3f;
    const GridFrame frame(field.grid);
    const Trilinear volume(field.grid, field.values);
    const std::optional<Trilinear> visibility = visibility_of(field.grid, style.visibility);
    const float voxel = frame.smallest_spacing();
    const float step =
        style.step > 0 ? std::max(static_cast<float>(style.step), 0.01f * voxel) : 0.5f * voxel;
    const float reference = style.reference_length > 0 ? static_cast<float>(style.reference_length) : voxel;
    const auto colour = [&](const glm::vec3& origin, const glm::vec3& direction) -> std::optional<glm::vec3> {
        const auto ray = frame.enter(origin, direction, volume.last());
        if (!ray) return std::nullopt;
        // Equal steps that end where the ray leaves, sampled in their middles.
        const auto steps = static_cast<std::size_t>(std::ceil((ray->end - ray->begin) / step));
        const float length = (ray->end - ray->begin) / static_cast<float>(std::max<std::size_t>(steps, 1));
        const float exponent = length / reference;
        const glm::vec3 light = light_of(style.light, ray->world_direction);
        float transmittance = 1;
        glm::vec3 sum(0);
        for (std::size_t i = 0; i < steps && transmittance > kOpaque; ++i) {
            const glm::vec3 index = ray->at(ray->begin + (static_cast<float>(i) + 0.5f) * length);
            const float value = volume(index);
            const float layer = transfer.opacity(value);
            if (layer <= 0 || (style.clipped && style.clipped(index))) continue;
            const float opacity = 1 - std::pow(1 - layer, exponent);
            glm::vec3 rgb = transfer.colour(value);
            if (style.local) {
                const glm::vec3 normal = frame.normal(volume.gradient(index));
                if (normal != glm::vec3(0))
                    rgb *= style.ambient + (1 - style.ambient) * std::abs(glm::dot(normal, light));
            }
            if (visibility) rgb *= std::clamp(style.visibility_gain * (*visibility)(index), 0.0f, 1.0f);
            sum += transmittance * opacity * rgb;
            transmittance *= 1 - opacity;
        }
        return sum + transmittance * options.background;
    };
    return render_rays(camera, options, colour);
}

}  // namespace dfield
