// Figure 2: displacement maps as pictures, one row an object, one column a mapping of directions.
#include <algorithm>
#include <array>

#include "baker/bake.hpp"
#include "baker/provenance.hpp"
#include "bench/paper/figures.hpp"
#include "format/sphere_points.hpp"

namespace dfield::paper {
namespace {

constexpr std::array<Mapping, 3> kMappings{Mapping::kPolar, Mapping::kRejection, Mapping::kConcentric};

std::span<const std::uint8_t> map_of(const DisplacementField& field, std::size_t index) {
    const std::size_t bytes = map_bytes(field.parameters);
    return std::span(field.texels).subspan(index * bytes, bytes);
}

// The sample on the +z side and somewhat above (y is up): the cow from its side, the cube's hole. By the
// frame rule +x is to the right in its map and +y upwards.
std::size_t shown_sample(const FieldParameters& parameters) {
    const auto points = sphere_points(parameters.positions, parameters.subdivision);
    return nearest_sphere_point(parameters.positions, parameters.subdivision, points.data(),
                                glm::normalize(glm::vec3(0, 0.66f, 0.75f)));
}

// Distances in greys, the nearest darkest; misses white.
Image picture_of(const DisplacementField& field, std::size_t index) {
    constexpr int kDarkest = 20, kLightest = 215;
    const auto map = map_of(field, index);
    int nearest = kMiss8, farthest = 0;
    for (const std::uint8_t texel : map)
        if (texel != kMiss8) {
            nearest = std::min<int>(nearest, texel);
            farthest = std::max<int>(farthest, texel);
        }
    Image image(field.parameters.map_size, field.parameters.map_size);
    for (std::size_t i = 0; i < map.size(); ++i)
        if (map[i] != kMiss8)
            std::fill_n(&image.rgb[3 * i], 3,
                        static_cast<std::uint8_t>(kDarkest + (map[i] - nearest) * (kLightest - kDarkest) /
                                                                 std::max(farthest - nearest, 1)));
    return image;
}

Image row_of(Lab& lab, const Model& model) {
    BakeOptions options;
    options.parameters = lab.parameters(0, 512);
    options.parameters.subdivision = 2;
    std::array<Image, kMappings.size()> images;
    std::array<std::string, kMappings.size()> captions;
    for (std::size_t i = 0; i < kMappings.size(); ++i) {
        options.parameters.mapping = kMappings[i];
        images[i] = picture_of(bake_field(model.mesh, options), shown_sample(options.parameters));
        captions[i] = model.name + ", " + name_of(kMappings[i]);
    }
    return image_row(images, captions);
}

}  // namespace

void write_figure2(Lab& lab, Page& page) {
    page.heading(2, "Figure 2: displacement maps");
    const std::uint32_t size = lab.parameters(0, 512).map_size;
    page.paragraph(
        "Maps of one positional sample, " + square(size) +
        " texels: dark is near the sample, light is far (stretched to the map's range), white is a miss. The "
        "polar map has phi to the right and theta downwards, so that its upper rows hold nearly one "
        "direction; the rejection map leaves 21.5% of its texels unused; the concentric map uses all of "
        "them.");
    std::vector<Image> rows;
    std::string names;
    for (const char* name : {"cow", "cube with a hole"})
        if (const Model* model = lab.find(name)) {
            rows.push_back(row_of(lab, *model));
            names += (names.empty() ? "" : " and ") + model->name;
        }
    page.picture("figure2", image_column(rows), "Displacement maps of " + names + ", three mappings");
}

}  // namespace dfield::paper
