// Figure 8, last column: several objects that occlude each other and the room.
#include <algorithm>
#include <array>

#include "baker/cli/comparison.hpp"
#include "baker/cli/comparison_picture.hpp"
#include "baker/cli/corner.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

using cli::text;

// Where an object stands: its box is scaled to a longest side of 1, and this is the box's corner.
struct Place {
    const Model* model;
    glm::vec3 corner;
    bool receives;
};

glm::mat4 transform_to(const Place& place) {
    const Bounds bounds = triangle_bounds(place.model->mesh);
    const glm::vec3 size = bounds.size();
    const float scale = 1 / std::max({size.x, size.y, size.z});
    glm::mat4 transform(scale);
    transform[3] = glm::vec4(place.corner - scale * bounds.min, 1);
    return transform;
}

// The paper's scene: the bunny casts only, igea and the lemon tree also receive.
std::vector<Place> places(const Lab& lab) {
    const auto pick = [&](const char* name, const char* own) {
        const Model* model = lab.find(name);
        return model ? model : lab.find(own);
    };
    return {{pick("bunny", "cube with a hole"), {0.1f, 0, 1.3f}, false},
            {pick("igea", "leafy tree"), {0.1f, 0, 0.1f}, true},
            {pick("lemon tree", "cube with a hole"), {1.3f, 0, 0.1f}, true}};
}

void add_picture(Lab& lab, const std::vector<Place>& objects, const cli::ComparisonInput& input,
                 const TriangleMesh& room, const cli::Comparison& result, Page& page) {
    std::vector<cli::PictureObject> drawn;
    std::size_t first = 0;
    const auto next_values = [&](const std::vector<float>& all, std::size_t count) {
        return std::vector<float>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                  all.begin() + static_cast<std::ptrdiff_t>(first + count));
    };
    drawn.push_back({&room, glm::mat4(1), next_values(result.reference, room.positions.size()),
                     next_values(result.lookup, room.positions.size()), true});
    first += room.positions.size();
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const TriangleMesh& mesh = objects[i].model->mesh;
        cli::PictureObject& object = drawn.emplace_back();
        object.mesh = &mesh;
        object.transform = input.casters[i].transform;
        object.reference = object.lookup = lab.self_visibility(*objects[i].model);
        if (!objects[i].receives) continue;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            object.reference[v] *= result.reference[first + v];
            object.lookup[v] *= result.lookup[first + v];
        }
        first += mesh.positions.size();
    }
    const std::uint32_t width = lab.pixels(400), height = lab.pixels(340);
    const auto images =
        cli::comparison_images(drawn, corner_camera(triangle_bounds(room), width, height), 0, width, height);
    const std::array<std::string, 3> captions{std::string("ray casting"), std::string("by lookup"),
                                              text("difference x5, RMS %.2f", result.rms_grey)};
    page.picture("several_objects", image_row(images, captions),
                 "Several objects in a room: reference, lookup, difference times five");
}

}  // namespace

void write_several_objects(Lab& lab, Page& page) {
    const std::vector<Place> objects = places(lab);
    const TriangleMesh room = cli::corner_room({glm::vec3(0), glm::vec3(1.25f)}, 0);

    cli::ComparisonInput input;
    input.directions = lab.directions(Rays::kConcentric).directions;
    input.converged_rays = 1;  // its column is not used
    input.repetitions = lab.rounds(2);
    input.groups.push_back({cli::placed_vertices(room, glm::mat4(1)), cli::ReceiverGroup::kNoOwner});
    std::size_t triangles = room.triangles.size();
    double bake_seconds = 0;
    std::vector<const Model*> baked;
    for (const Place& place : objects) {
        auto at = std::find(baked.begin(), baked.end(), place.model);
        if (at == baked.end()) {
            const Baked& field = lab.baked(*place.model, lab.parameters());
            bake_seconds += field.seconds();
            input.fields.push_back(field.bytes);
            at = baked.insert(baked.end(), place.model);
        }
        const glm::mat4 transform = transform_to(place);
        triangles += place.model->mesh.triangles.size();
        if (place.receives)
            input.groups.push_back(
                {cli::placed_vertices(place.model->mesh, transform), input.casters.size()});
        input.casters.push_back(
            {&place.model->mesh, static_cast<std::size_t>(at - baked.begin()), transform});
    }
    const cli::Comparison result = cli::compare(input);

    page.heading(3, "Several objects");
    page.paragraph("The paper's last column: the room receives, " + objects[0].model->name + " casts, " +
                   objects[1].model->name + " and " + objects[2].model->name +
                   " do both. Boxes are scaled to the same longest side. Each object's occlusion by itself "
                   "is baked once and multiplied in (in the "
                   "picture; it is in neither time nor error, on both sides).");
    Table table({"objects", "triangles", "receivers", "rays", "ray casting, s", "bake, s", "AO by lookup, s",
                 "speedup, ×", "RMS"});
    table.row({std::to_string(objects.size()), grouped(triangles), grouped(result.receivers),
               grouped(result.rays), text("%.3f", result.embree_seconds), text("%.2f", bake_seconds),
               text("%.3f", result.lookup_seconds), text("%.2f", result.speedup),
               text("%.2f", result.rms_grey)});
    page.table(table);
    add_picture(lab, objects, input, room, result, page);
    page.paragraph(
        "The lookup asks every object in turn, Embree one structure of all triangles: the cost of a lookup "
        "grows with the objects, not with their triangles.");
}

}  // namespace dfield::paper
