// What the figures share: the models, their fields, the paper's corner around them, and ray casting there.
// Everything is made once, when first asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "baker/cli/runtime_scene.hpp"
#include "baker/mesh.hpp"
#include "format/field.hpp"

namespace dfield::paper {

using cli::Receivers;

struct Model {
    std::string name;
    TriangleMesh mesh;
};

enum class Room { kGap, kContact };  // scenes `corner` and `corner-contact` of `dfield compare`
enum class Rays { kConcentric, kPolar, kConverged };  // of a receiver; the last are many concentric ones

inline constexpr float kUnbounded = std::numeric_limits<float>::infinity();

struct Directions {
    std::vector<glm::vec3> directions;  // around +z
    std::vector<float> weights;         // empty: even
};

struct Baked {
    FieldParameters parameters;
    std::vector<std::byte> bytes;  // of the .dfield
    std::uint64_t rays = 0;
    double build_seconds = 0, trace_seconds = 0;  // on one core, the fastest of several bakes

    double seconds() const { return build_seconds + trace_seconds; }
    double mrays_per_s() const { return static_cast<double>(rays) / trace_seconds * 1e-6; }
};

class Lab {
  public:
    // `shared` may be missing. `quick` shrinks everything to what a test can wait for, and leaves `shared`
    // alone.
    Lab(const std::filesystem::path& own, const std::filesystem::path& shared, bool quick);

    bool quick() const { return quick_; }
    const std::deque<Model>& models() const { return models_; }
    const std::vector<std::string>& missing() const { return missing_; }
    const Model* find(const std::string& name) const;  // null where it is missing
    const Model& subject() const;                      // the bunny, or the cube with a hole in its place

    // The paper's sizes, made smaller by quick().
    FieldParameters parameters(std::uint32_t subdivision = 32, std::uint32_t map_size = 32,
                               std::uint32_t bits = 8) const;
    std::uint32_t pixels(std::uint32_t full) const { return quick_ ? full / 4 : full; }
    int rounds(int full) const { return quick_ ? 1 : full; }

    // A bake on one core. Short ones are repeated, the fastest counts.
    Baked timed_bake(const TriangleMesh& mesh, const FieldParameters& parameters) const;
    const Baked& baked(const Model& model, const FieldParameters& parameters);
    const TriangleMesh& room(const Model& model, Room room);
    const Receivers& receivers(const Model& model, Room room);
    const Directions& directions(Rays rays) const { return directions_.at(rays); }
    // Visibility. With a reach, occlusion falls linearly with a hit's distance, to 0 at the reach.
    const std::vector<float>& ray_cast(const Model& model, Room room, Rays rays, float reach = kUnbounded);
    // The room's side: the reach that figures with falloff use.
    float reach(const Model& model) const;
    const std::vector<float>& self_visibility(const Model& model);

  private:
    void load(const std::string& name, const std::filesystem::path& path);

    bool quick_;
    std::deque<Model> models_;  // whose addresses are keys
    std::vector<std::string> missing_;
    std::map<Rays, Directions> directions_;
    using FieldKey =
        std::tuple<const Model*, Positions, std::uint32_t, Mapping, std::uint32_t, std::uint32_t>;
    std::map<FieldKey, Baked> baked_;
    std::map<std::pair<const Model*, Room>, TriangleMesh> rooms_;
    std::map<std::pair<const Model*, Room>, Receivers> receivers_;
    std::map<std::tuple<const Model*, Room, Rays, float>, std::vector<float>> ray_cast_;
    std::map<const Model*, std::vector<float>> self_;
};

}  // namespace dfield::paper
