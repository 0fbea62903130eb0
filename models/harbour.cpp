#include "models/harbour.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

#include "models/glb_builder.hpp"

namespace dfield::models {
namespace {

// Several shapes as one: faces index what is appended before them.
void append(Shape& shape, const Shape& other) {
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    if (shape.parts.empty()) shape.parts.push_back({"all", {}});
    shape.positions.insert(shape.positions.end(), other.positions.begin(), other.positions.end());
    for (const Part& part : other.parts)
        for (Face face : part.faces) {
            for (std::uint32_t* index : {&face.a, &face.b, &face.c, &face.d})
                if (*index != kNoIndex) *index += first;
            shape.parts[0].faces.push_back(face);
        }
}

// A ring of points below, one above: walls, a lid, and a bottom unless it stands on something.
Shape prism(const std::vector<glm::dvec3>& below, const std::vector<glm::dvec3>& above) {
    const auto n = static_cast<std::uint32_t>(below.size());
    Shape shape;
    for (const auto& ring : {below, above})
        for (const glm::dvec3& point : ring) shape.positions.push_back(quantized(point));
    std::vector<Face> faces;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = (i + 1) % n;
        faces.push_back({i, next, n + next, n + i});
    }
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
        faces.push_back({n, n + i, n + i + 1});
        faces.push_back({0, i + 1, i});
    }
    shape.parts.push_back({"all", std::move(faces)});
    return shape;
}

Shape box(const glm::dvec3& low, const glm::dvec3& high) {
    const auto ring = [&](double y) {
        return std::vector<glm::dvec3>{
            {low.x, y, high.z}, {high.x, y, high.z}, {high.x, y, low.z}, {low.x, y, low.z}};
    };
    return prism(ring(low.y), ring(high.y));
}

// A round post that may narrow upwards.
Shape post(const glm::dvec3& foot, double height, double radius, double top_radius, int sides) {
    std::vector<glm::dvec3> below, above;
    for (int i = 0; i < sides; ++i) {
        const double angle = glm::radians(360.0 * i / sides);
        const glm::dvec3 out(std::cos(angle), 0, -std::sin(angle));
        below.push_back(foot + radius * out);
        above.push_back(foot + glm::dvec3(0, height, 0) + top_radius * out);
    }
    return prism(below, above);
}

// A gable over x, from eaves to ridge.
Shape roof(const glm::dvec3& low, const glm::dvec3& high) {
    const double middle = 0.5 * (low.z + high.z);
    Shape shape;
    for (const double x : {low.x, high.x})
        for (const auto& [y, z] : {std::pair{low.y, high.z}, {low.y, low.z}, {high.y, middle}})
            shape.positions.push_back(quantized({x, y, z}));
    shape.parts.push_back({"all", {{0, 2, 1}, {3, 4, 5}, {0, 3, 5, 2}, {4, 1, 2, 5}, {0, 1, 4, 3}}});
    return shape;
}

struct Hull {
    Shape shape;
    std::vector<glm::dvec3> colours;
};

// Ribs from stern to bow, each from the keel over the waterline to the deck; the waterline parts two colours.
Hull hull(double length, double width, double height, const glm::dvec3& bottom, const glm::dvec3& side) {
    constexpr int kRibs = 8;
    Hull hull;
    std::vector<Face> faces;
    for (int rib = 0; rib <= kRibs; ++rib) {
        const double along = static_cast<double>(rib) / kRibs;  // 0 stern, 1 bow
        const double breadth =
            0.5 * width * (along < 0.4 ? 0.82 + 0.45 * along : 0.04 + 0.96 * std::sqrt((1 - along) / 0.6));
        const double sheer =
            0.12 * height * (2 * along - 1) * (2 * along - 1) + 0.25 * height * along * along;
        const double x = length * (along - 0.5);
        // Keel, waterline and deck of one side, then of the other.
        for (const double mirror : {1.0, -1.0}) {
            const glm::dvec3 keel(x - 0.06 * length * along, -0.45 * height, 0.15 * mirror * breadth);
            const glm::dvec3 water(x - 0.02 * length * along, 0.05 * height, 0.86 * mirror * breadth);
            const glm::dvec3 deck(x, 0.75 * height + sheer, mirror * breadth);
            // The waterline twice: each strake has its own colour.
            for (const glm::dvec3& point : {keel, water, water, deck})
                hull.shape.positions.push_back(quantized(point));
            for (const glm::dvec3& colour : {bottom, bottom, side, side}) hull.colours.push_back(colour);
        }
    }
    for (std::uint32_t rib = 0; rib < kRibs; ++rib) {
        const std::uint32_t a = 8 * rib, b = a + 8;
        for (const std::uint32_t strake : {0u, 2u}) {
            faces.push_back({a + strake, b + strake, b + strake + 1, a + strake + 1});
            faces.push_back({b + 4 + strake, a + 4 + strake, a + 5 + strake, b + 5 + strake});
        }
    }
    faces.push_back({0, 1, 5, 4});  // stern
    faces.push_back({2, 3, 7, 6});
    hull.shape.parts.push_back({"hull", std::move(faces)});
    return hull;
}

// What closes a hull a little below its rail.
Shape deck(const Hull& hull, double drop) {
    Shape shape;
    std::vector<Face> faces;
    for (std::size_t i = 3; i < hull.shape.positions.size(); i += 4)
        shape.positions.push_back(quantized(hull.shape.positions[i] - glm::dvec3(0, drop, 0)));
    for (std::uint32_t i = 0; i + 3 < shape.positions.size(); i += 2)
        faces.push_back({i, i + 2, i + 3, i + 1});
    shape.parts.push_back({"deck", std::move(faces)});
    return shape;
}

Shape sail(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return {{quantized(a), quantized(b), quantized(c)}, {{"sail", {{0, 1, 2}}}}};
}

class Harbour {
  public:
    Harbour() : glb_("harbour") {}

    std::string build() {
        shore();
        buildings();
        goods();
        boats();
        crane();
        camera();
        return glb_.finish();
    }

  private:
    std::size_t mesh(const char* name, const Shape& shape, const glm::dvec3& colour,
                     bool double_sided = false) {
        return glb_.add_faceted(name, shape, glb_.add_material(name, colour, double_sided));
    }
    void place(std::size_t mesh, const char* name, const glm::dvec3& at, double yaw = 0,
               const glm::dvec3& scale = glm::dvec3(1)) {
        Json node = placed_node(name, at, yaw, scale);
        node["mesh"] = mesh;
        glb_.add_root(std::move(node));
    }
    void stand(const char* name, const Shape& shape, const glm::dvec3& colour) {
        place(mesh(name, shape, colour), name, {0, 0, 0});
    }

    void shore() {
        stand("water", box({-11, -1.4, -6}, {11, -0.7, 9}), {0.09, 0.24, 0.3});
        stand("quay", box({-11, -1.6, -9}, {11, 0, 0}), {0.66, 0.63, 0.56});
        stand("kerb", box({-11, 0, -0.32}, {11, 0.14, 0}), {0.74, 0.72, 0.68});
        Shape bollards;
        for (int i = -3; i <= 3; ++i) {
            append(bollards, post({3.1 * i + 0.4, 0.14, -0.16}, 0.3, 0.1, 0.08, 8));
            append(bollards, post({3.1 * i + 0.4, 0.44, -0.16}, 0.08, 0.15, 0.13, 8));
        }
        stand("bollards", bollards, {0.2, 0.2, 0.22});
    }

    void buildings() {
        stand("warehouse", box({-9.6, 0, -8}, {-3.4, 2.5, -5}), {0.82, 0.78, 0.68});
        stand("warehouse_roof", roof({-9.9, 2.4, -8.4}, {-3.1, 4, -4.6}), {0.62, 0.17, 0.1});
        Shape doors;
        for (const double x : {-8.4, -5.8}) append(doors, box({x, 0, -5}, {x + 1.5, 1.9, -4.9}));
        stand("doors", doors, {0.1, 0.38, 0.2});
        stand("office", box({-2.6, 0, -7.6}, {0.4, 1.9, -5.4}), {0.75, 0.52, 0.2});
        stand("office_roof", box({-2.8, 1.9, -7.8}, {0.6, 2.05, -5.2}), {0.4, 0.42, 0.45});
        Shape steps;
        for (int i = 0; i < 3; ++i)
            append(steps, box({-1.6, 0, -5.4}, {-0.6, 0.16 * (3 - i), -5.1 + 0.25 * i}));
        stand("steps", steps, {0.7, 0.7, 0.7});
    }

    void goods() {
        const Shape cube = box({-0.4, 0, -0.4}, {0.4, 0.8, 0.4});
        const std::size_t colours[] = {
            mesh("crate_red", cube, {0.78, 0.09, 0.06}), mesh("crate_yellow", cube, {0.85, 0.66, 0.06}),
            mesh("crate_blue", cube, {0.07, 0.2, 0.68}), mesh("crate_wood", cube, {0.55, 0.38, 0.2}),
            mesh("crate_white", cube, {0.84, 0.84, 0.82})};
        struct Crate {
            std::size_t colour;
            glm::dvec3 at;
            double yaw;
        };
        for (const Crate& crate : {Crate{0, {1.2, 0, -1.4}, 8},
                                   {4, {2.1, 0, -1.5}, -3},
                                   {3, {1.5, 0, -2.4}, 20},
                                   {1, {1.6, 0.8, -1.6}, 14},
                                   {4, {-1.4, 0, -1.6}, -12},
                                   {0, {-2.4, 0, -1.8}, 5},
                                   {2, {-1.9, 0, -2.7}, 31},
                                   {3, {-2.1, 0.8, -2}, 24},
                                   {4, {-4.6, 0, -2.2}, 4},
                                   {2, {-5.5, 0, -2.3}, -6},
                                   {1, {-5, 0.8, -2.3}, 17},
                                   {3, {-4.9, 0, -3.3}, 40}})
            place(colours[crate.colour], "crate", crate.at, crate.yaw);

        const Shape container = box({-1.5, 0, -0.6}, {1.5, 1.2, 0.6});
        const std::size_t orange = mesh("container_orange", container, {0.84, 0.3, 0.04}),
                          green = mesh("container_green", container, {0.08, 0.5, 0.16}),
                          white = mesh("container_white", container, {0.82, 0.82, 0.8});
        place(orange, "container", {5.2, 0, -5.4}, 3);
        place(white, "container", {5.3, 0, -3.9}, -2);
        place(green, "container", {5.1, 1.2, -4.7}, 6);
        place(green, "container", {8.6, 0, -4.6}, 88);
        place(orange, "container", {9.9, 0, -4.8}, 91);

        const std::size_t barrel = mesh("barrel", post({0, 0, 0}, 0.72, 0.27, 0.27, 12), {0.12, 0.42, 0.5});
        for (const auto& [x, z] :
             {std::pair{3.3, -1.1}, {3.9, -1.3}, {3.5, -1.7}, {-6.8, -1.4}, {-7.4, -1.2}})
            place(barrel, "barrel", {x, 0, z});
    }

    // A boat alongside: hull, deck, cabin, mast, boom and sails.
    void boat(const char* name, const glm::dvec3& at, double yaw, double length, const glm::dvec3& bottom,
              const glm::dvec3& side, const glm::dvec3& cabin, bool rigged) {
        const double width = 0.34 * length, height = 0.24 * length;
        const Hull body = hull(length, width, height, bottom, side);
        const std::size_t paint = glb_.add_material(name, {1, 1, 1}, true);
        place(glb_.add_faceted(name, body.shape, paint, body.colours), name, at, yaw);
        place(mesh("deck", deck(body, 0.08 * height), {0.6, 0.46, 0.28}), "deck", at, yaw);
        place(mesh("cabin",
                   box({-0.3 * length, 0.5 * height, -0.22 * width},
                       {0.02 * length, 1.15 * height, 0.22 * width}),
                   cabin),
              "cabin", at, yaw);
        if (!rigged) return;
        const glm::dvec3 foot(0.1 * length, 0.6 * height, 0);
        Shape spars = post(foot, 1.35 * length, 0.018 * length, 0.009 * length, 8);
        append(spars, box({-0.36 * length, 1.5 * height, -0.01 * length},
                          {0.1 * length, 1.6 * height, 0.01 * length}));
        place(mesh("spars", spars, {0.5, 0.34, 0.18}), "spars", at, yaw);
        const double top = 1.85 * length * 0.72;
        Shape sails = sail({0.08 * length, 1.66 * height, 0}, {0.08 * length, top, 0},
                           {-0.34 * length, 1.66 * height, 0.02 * length});
        append(sails, sail({0.12 * length, 0.94 * top, 0}, {0.13 * length, 1.5 * height, 0},
                           {0.5 * length, 1.2 * height, -0.02 * length}));
        place(mesh("sails", sails, {0.86, 0.83, 0.74}, true), "sails", at, yaw);
    }

    void boats() {
        const glm::dvec3 red(0.72, 0.06, 0.05), blue(0.06, 0.16, 0.55), white(0.86, 0.86, 0.84),
            green(0.06, 0.4, 0.22), yellow(0.85, 0.62, 0.08);
        boat("ketch", {-1.6, -0.65, 1.15}, 2, 4.6, red, white, yellow, true);
        boat("tug", {4.1, -0.65, 1.05}, -3, 3.4, blue, red, white, false);
        boat("dinghy", {-6.2, -0.66, 1.3}, 12, 2.4, white, green, red, true);
        boat("sloop", {-4.2, -0.66, 4.6}, 24, 3, blue, yellow, white, true);
    }

    void crane() {
        Shape shape = post({8.6, 0, -1.6}, 4.2, 0.3, 0.22, 8);
        append(shape, box({8.1, 0, -2.1}, {9.1, 0.35, -1.1}));
        append(shape, box({8.2, 4.2, -2.2}, {9, 4.8, -1.2}));
        append(shape, box({8.45, 4.5, -1.3}, {8.75, 4.75, 2.6}));
        append(shape, box({8.56, 2.1, 2.3}, {8.62, 4.5, 2.36}));
        stand("crane", shape, {0.86, 0.6, 0.05});
        stand("load", box({8.2, 1.4, 1.9}, {9, 2.1, 2.75}), {0.72, 0.1, 0.08});
    }

    void camera() {
        const glm::dvec3 eye(7.4, 5.6, 14.6), target(-0.2, 0.7, -1.8), look = target - eye;
        const double yaw = std::atan2(-look.x, -look.z) / 2,
                     pitch = std::atan2(look.y, std::hypot(look.x, look.z)) / 2;
        const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6 + 0.0; };
        glb_.json["cameras"] =
            Json::array({{{"name", "mole"},
                          {"type", "perspective"},
                          {"perspective", {{"yfov", 0.62}, {"znear", 0.1}, {"zfar", 100.0}}}}});
        glb_.add_root(
            {{"name", "camera"},
             {"camera", 0},
             {"translation", {eye.x, eye.y, eye.z}},
             {"rotation",
              {rounded(std::cos(yaw) * std::sin(pitch)), rounded(std::sin(yaw) * std::cos(pitch)),
               rounded(-std::sin(yaw) * std::sin(pitch)), rounded(std::cos(yaw) * std::cos(pitch))}}});
    }

    GlbBuilder glb_;
};

}  // namespace

std::string harbour_glb() {
    return Harbour().build();
}

}  // namespace dfield::models
