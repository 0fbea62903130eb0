// What `dfield screen` looks at: a scene seen by a camera, or a G-buffer that somebody else made.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/screen/lit_scene.hpp"

namespace dfield::cli {

// SCENE|GBUFFER --size --scene --crease, and the groups "Camera" and "Light".
struct ScreenInput {
    std::string file, reference_scene, camera, size = "800x600";
    std::optional<std::array<float, 3>> eye, target, view, sun;
    std::array<float, 3> up{0, 1, 0}, background{0.62f, 0.76f, 0.9f}, sun_colour{0.9f, 0.85f, 0.75f};
    std::optional<float> fov, orthographic;
    float crease_degrees = 180;
};
void add_screen_input(CLI::App& command, ScreenInput& input);

struct ScreenSubject {
    std::unique_ptr<ImportedScene> scene;  // null: a G-buffer without --scene
    std::unique_ptr<LitScene> lit;         // of it
    GBuffer buffer;
    std::vector<std::uint32_t> instances;  // that pixels show, ~0u none; empty where the buffer was read
    double trace_seconds = 0;              // 0 where the buffer was read
    std::string camera;                    // in words

    // A tenth of the longest side of what there is: the scene, or what the buffer shows.
    float default_radius() const;
};
// Reads or traces it; warnings go to stderr. Throws Error.
ScreenSubject load_screen_subject(const ScreenInput& input, const CommonOptions& common);

glm::vec3 vector_of(const std::array<float, 3>& v);

}  // namespace dfield::cli
