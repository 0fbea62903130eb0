// Figure 2: displacement maps as pictures, one row an object, one column a mapping of directions.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "baker/bake.hpp"
#include "baker/provenance.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

constexpr std::array<Mapping, 3> kMappings{Mapping::kPolar, Mapping::kRejection, Mapping::kConcentric};

std::span<const std::uint8_t> map_of(const DisplacementField& field, std::size_t index) {
    const std::size_t bytes = map_bytes(field.parameters);
    return std::span(field.texels).subspan(index * bytes, bytes);
}

// Texels whose right or lower neighbour differs by more than a step of the surface would: outlines, of the
// object and of its parts in front of each other.
std::size_t outline_length(std::span<const std::uint8_t> map, std::uint32_t size) {
    constexpr int kStep = 6;
    std::size_t length = 0;
    for (std::uint32_t t = 0; t + 1 < size; ++t)
        for (std::uint32_t s = 0; s + 1 < size; ++s) {
            const int here = map[t * size + s];
            length += std::abs(here - map[t * size + s + 1]) > kStep ||
                      std::abs(here - map[(t + 1) * size + s]) > kStep;
        }
    return length;
}

// The sample that shows most of the object's form.
std::size_t best_sample(const DisplacementField& field) {
    std::size_t best = 0, longest = 0;
    for (std::size_t i = 0; i < position_count(field.parameters); ++i)
        if (const std::size_t length = outline_length(map_of(field, i), field.parameters.map_size);
            length > longest) {
            best = i;
            longest = length;
        }
    return best;
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
    std::size_t sample = 0;
    for (std::size_t i = kMappings.size(); i-- > 0;) {  // the concentric map, the last, chooses the sample
        options.parameters.mapping = kMappings[i];
        const DisplacementField field = bake_field(model.mesh, options);
        if (kMappings[i] == Mapping::kConcentric) sample = best_sample(field);
        images[i] = picture_of(field, sample);
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
        "sample, of 18, is the one whose concentric map has the longest outlines. The polar map has phi to "
        "the right and theta downwards, so that its upper rows hold nearly one direction; the rejection map "
        "leaves 21.5% of its texels unused; the concentric map uses all of them.");
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
