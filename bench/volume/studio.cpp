#include "bench/volume/studio.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/vector_uint3_sized.hpp>
#include <limits>
#include <mutex>
#include <tuple>

namespace dfield::volumes {
namespace {

// Neither black nor white, so that what is open and what is hidden stand out both.
constexpr glm::u8vec3 kBackground{77, 97, 122};

bool is_background(const std::uint8_t* rgb) {
    return rgb[0] == kBackground.r && rgb[1] == kBackground.g && rgb[2] == kBackground.b;
}

// World bounds of the voxels inside.
Bounds matter_bounds(const VolumeGrid& grid, const std::vector<float>& distance) {
    Bounds bounds{glm::vec3(std::numeric_limits<float>::infinity()),
                  glm::vec3(-std::numeric_limits<float>::infinity())};
    std::size_t i = 0;
    for (std::size_t z = 0; z < grid.size[2]; ++z)
        for (std::size_t y = 0; y < grid.size[1]; ++y)
            for (std::size_t x = 0; x < grid.size[0]; ++x)
                if (std::signbit(distance[i++])) {
                    const glm::vec3 position(grid.position(glm::dvec3(x, y, z)));
                    bounds.min = glm::min(bounds.min, position);
                    bounds.max = glm::max(bounds.max, position);
                }
    return bounds;
}

bool comes_before(const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

bool even_octants(const dfield_sweep_desc& desc) {
    return desc.octants == DFIELD_ALL_OCTANTS &&
           std::all_of(std::begin(desc.intensities), std::end(desc.intensities),
                       [](float intensity) { return intensity == 1; });
}

}  // namespace

Studio::Studio(const Subject& subject, const View& view, const Stock& stock)
    : subject_(subject), sweeper_(subject.name, subject.volume, subject.isovalue, 0), runner_(sweeper_, 1) {
    runner_.sweep(desc(DFIELD_FORM_COMBINED));
    distance_ = runner_.distance();
    options_.width = stock.pixels(view.width);
    options_.height = stock.pixels(view.height);
    options_.samples = stock.quick() ? 1 : 2;
    options_.background = glm::vec3(kBackground) / 255.0f;
    camera_ =
        frame_bounds(matter_bounds(subject.volume.grid, distance_), view.to_eye, view.up, view.fov_degrees,
                     static_cast<float>(view.width) / static_cast<float>(view.height));
}

dfield_sweep_desc Studio::desc(dfield_occlusion_form form) const {
    dfield_sweep_desc desc = sweep_defaults();
    desc.isovalue = subject_.isovalue;
    desc.form = form;
    return desc;
}

IsosurfaceStyle Studio::unlit() const {
    IsosurfaceStyle style;
    style.local = false;
    return style;
}

Image Studio::draw(const IsosurfaceStyle& style) const {
    return render_isosurface({subject_.volume.grid, distance_}, camera_, style, options_);
}

dfield_volume_points Studio::points() {
    if (indices_.empty()) {
        // A first picture, for the points that it asks of, in any order.
        std::mutex mutex;
        IsosurfaceStyle style = unlit();
        style.visibility_at = [&](const glm::vec3& index) {
            const std::lock_guard<std::mutex> lock(mutex);
            indices_.push_back(index);
            return 1.0f;
        };
        draw(style);
        std::sort(indices_.begin(), indices_.end(), comes_before);
        const float* const spacing = sweeper_.grid().spacing;
        for (const glm::vec3& index : indices_)
            positions_.push_back(index * glm::vec3(spacing[0], spacing[1], spacing[2]));
    }
    dfield_volume_points points{};
    points.count = positions_.size();
    points.positions = &positions_.front().x;
    return points;
}

Image Studio::draw_points(const std::vector<float>& values, float gamma) const {
    IsosurfaceStyle style = unlit();
    style.visibility_at = [&](const glm::vec3& index) {
        const auto at = std::lower_bound(indices_.begin(), indices_.end(), index, comes_before);
        return std::pow(values[static_cast<std::size_t>(at - indices_.begin())], 1 / gamma);
    };
    return draw(style);
}

Image Studio::local(const glm::vec3& light) const {
    IsosurfaceStyle style;
    style.light = light;
    return draw(style);
}

Image Studio::swept(const dfield_sweep_desc& desc) {
    runner_.sweep(desc);
    IsosurfaceStyle style = unlit();
    style.visibility = runner_.visibility();
    if (desc.form == DFIELD_FORM_PAPER && even_octants(desc) && !desc.through)
        return draw_points(runner_.at(desc, points()), desc.gamma);
    return draw(style);
}

Image Studio::by_rays(std::uint32_t rays, float gamma) {
    if (truth_.empty()) {
        const dfield_volume_points where = points();
        truth_.resize(where.count);
        sweeper_.field(distance_.data()).visibility_by_rays(where, rays, 0, truth_.data());
    }
    return draw_points(truth_, gamma);
}

Image Studio::hard_shadows(const glm::vec3& light) const {
    IsosurfaceStyle style;
    style.light = light;
    style.hard_shadows = true;
    return draw(style);
}

Image Studio::soft_shadows(const dfield_sweep_desc& desc, float gain) {
    runner_.sweep(desc);
    std::vector<float> share = runner_.visibility();
    for (float& value : share) value *= gain;
    IsosurfaceStyle style = unlit();
    style.shadows = true;
    style.visibility = share;
    return draw(style);
}

Image Studio::soft_shadows_of_light(dfield_sweep_desc desc, const glm::vec3& light) {
    const glm::vec3 turned = cli::to_sweep_frame(subject_.volume.grid, light);
    for (int axis = 0; axis < 3; ++axis) desc.light[axis] = turned[axis];
    runner_.sweep(desc);
    IsosurfaceStyle style;
    style.light = light;
    style.shadows = true;
    style.visibility = runner_.visibility();
    return draw(style);
}

double picture_rms(const Image& a, const Image& b) {
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3)
        if (!is_background(&a.rgb[i]) || !is_background(&b.rgb[i])) {
            const double difference = static_cast<double>(a.rgb[i]) - b.rgb[i];
            squares += difference * difference;
            ++count;
        }
    return count ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

double picture_mean(const Image& image) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
        if (!is_background(&image.rgb[i])) sum += image.rgb[i], ++count;
    return count ? sum / static_cast<double>(count) : 0;
}

}  // namespace dfield::volumes
