#include "baker/cli/screen_input.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "baker/cli/arguments.hpp"
#include "baker/cli/runtime_scene.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"
#include "baker/picture/camera.hpp"
#include "baker/screen/ray_reference.hpp"

namespace dfield::cli {
namespace {

constexpr float kFov = 40;

struct Size {
    std::uint32_t width = 0, height = 0;
    float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
};

Size size_of(const std::string& given) {
    Size size;
    const char* const end = given.data() + given.size();
    const auto [cross, bad] = std::from_chars(given.data(), end, size.width);
    const bool first = bad == std::errc() && cross != end && (*cross == 'x' || *cross == 'X');
    if (first) {
        const auto [last, error] = std::from_chars(cross + 1, end, size.height);
        if (error == std::errc() && last == end && size.width > 0 && size.height > 0 &&
            size.width <= kMaxScreenSide && size.height <= kMaxScreenSide)
            return size;
    }
    throw Error(ExitCode::kUsage, "--size: '" + given + "' is no size such as 800x600; sides are 1 to " +
                                      std::to_string(kMaxScreenSide));
}

const SceneCamera& named_camera(const ScreenInput& input, const ImportedScene& scene) {
    std::string names;
    for (const SceneCamera& camera : scene.cameras) {
        if (input.camera.empty() || camera.name == input.camera) return camera;
        names += (names.empty() ? "'" : ", '") + camera.name + "'";
    }
    throw InputError(input.file + ": its scene has no camera '" + input.camera + "'; " +
                     (names.empty() ? "it has none at all" : "it has " + names));
}

ScreenCamera camera_of_scene(const SceneCamera& source, float aspect) {
    ScreenCamera camera;
    camera.to_world = source.to_world;
    camera.orthographic = source.orthographic;
    camera.half_height = source.half_height;
    camera.half_width = aspect * source.half_height;
    camera.near = source.near;
    camera.far = source.far;
    return camera;
}

// --eye and --target, else the scene's own camera unless flags say where to look from, else the whole scene
// framed.
ScreenCamera camera_for(const ScreenInput& input, const ImportedScene& scene, const Bounds& bounds,
                        float aspect, std::string& words) {
    const glm::vec3 up = vector_of(input.up);
    if (up == glm::vec3(0)) throw Error(ExitCode::kUsage, "--up: 0 0 0 is no direction");
    ScreenCamera camera;
    if (input.eye) {
        const glm::vec3 eye = vector_of(*input.eye),
                        target = input.target ? vector_of(*input.target) : bounds.centre();
        if (eye == target) throw Error(ExitCode::kUsage, "--eye and --target are the same point");
        camera = look_at(eye, target, up, input.fov.value_or(kFov), aspect);
        words = "--eye";
    } else if (!input.camera.empty() || (!scene.cameras.empty() && !input.view && !input.target)) {
        const SceneCamera& source = named_camera(input, scene);
        camera = camera_of_scene(source, aspect);
        words = "camera '" + source.name + "'";
        if (input.fov && !camera.orthographic) {
            camera.half_height = std::tan(0.5f * glm::radians(*input.fov));
            camera.half_width = aspect * camera.half_height;
        }
    } else {
        if (input.target) throw Error(ExitCode::kUsage, "--target goes with --eye");
        const glm::vec3 view = input.view ? vector_of(*input.view) : glm::vec3(0.6f, 0.55f, 1);
        if (view == glm::vec3(0)) throw Error(ExitCode::kUsage, "--view: 0 0 0 is no direction");
        camera = input.orthographic ? frame_orthographic(bounds, view, up, aspect)
                                    : frame_perspective(bounds, view, up, input.fov.value_or(kFov), aspect);
        words = "framed";
    }
    if (!input.orthographic) return camera;
    if (*input.orthographic == 0)  // from where the camera looks: its own size is an angle
        return frame_orthographic(bounds, glm::vec3(camera.to_world[2]), glm::vec3(camera.to_world[1]),
                                  aspect);
    camera.orthographic = true;
    camera.half_height = 0.5f * *input.orthographic;
    camera.half_width = aspect * camera.half_height;
    return camera;
}

// From the upper left behind the camera, so that what is seen is lit and casts shadows that are seen.
glm::vec3 default_sun(const ScreenCamera& camera, const glm::vec3& up) {
    const glm::vec3 right(camera.to_world[0]), back(camera.to_world[2]);
    return -0.55f * right + 1.0f * glm::normalize(up) + 0.45f * back;
}

std::unique_ptr<ImportedScene> imported(const std::string& file, float crease_degrees) {
    auto scene = std::make_unique<ImportedScene>(
        import_scene(file, {.crease_degrees = crease_degrees, .looks = true}));
    note_flat_nodes(*scene);
    warn_of(file, scene->report);
    return scene;
}

CLI::Option* add_vector(CLI::App& command, const std::string& name, auto& value,
                        const std::string& description, const char* group) {
    return command.add_option(name, value, description)
        ->type_name("X Y Z")
        ->delimiter(',')
        ->check(finite_number())
        ->group(group);
}

}  // namespace

glm::vec3 vector_of(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

void add_screen_input(CLI::App& command, ScreenInput& input) {
    command.add_option("FILE", input.file,
                       "A scene (GLB, glTF, OBJ, PLY, OFF, STL), or a G-buffer: .exr, or .json with PNGs "
                       "(docs/gbuffer.md)");
    command.add_option("--size", input.size, "Pixels of a scene's picture; a G-buffer has its own")
        ->type_name("WxH")
        ->capture_default_str();
    command.add_option("--scene", input.reference_scene,
                       "The scene that a G-buffer shows, in the world of its to_world, for rms_grey_world");
    command
        .add_option(
            "--crease", input.crease_degrees,
            "Where the scene's file has no normals: faces that meet at more than this many degrees do "
            "not smooth")
        ->capture_default_str()
        ->check(number_between(0, 180));
    command
        .add_option("--camera", input.camera,
                    "A camera of the glTF, by its name; default: its first; the whole scene framed where it "
                    "has none")
        ->group("Camera");
    add_vector(command, "--eye", input.eye, "Look from this point", "Camera");
    add_vector(command, "--target", input.target, "--eye: to this point; default: the scene's middle",
               "Camera");
    add_vector(command, "--view", input.view,
               "From the scene towards the eye, with the whole scene framed; default 0.6 0.55 1", "Camera");
    add_vector(command, "--up", input.up, "What is up in the picture; default 0 1 0", "Camera");
    command
        .add_option(
            "--fov", input.fov,
            "Vertical field of view, degrees, default 40; of a G-buffer that does not say its camera too")
        ->check(number_between(1, 170))
        ->group("Camera");
    command
        .add_option("--orthographic", input.orthographic,
                    "No perspective; the picture's height in world units, 0: the whole scene")
        ->check(number_from_zero())
        ->excludes("--fov")
        ->group("Camera");
    command.get_option("--view")->excludes("--eye")->excludes("--camera");
    command.get_option("--eye")->excludes("--camera");
    add_vector(command, "--sun", input.sun,
               "Towards the sun, whose light surfaces reflect; default: from the upper left", "Light");
    add_vector(command, "--sun-colour", input.sun_colour,
               "What a white surface that faces it reflects; default 0.9 0.85 0.75", "Light")
        ->check(number_between(0, 1e6));
    add_vector(command, "--background", input.background, "Behind lit pictures; default 0.62 0.76 0.9",
               "Light")
        ->check(number_between(0, 1));
}

float ScreenSubject::default_radius() const {
    if (lit) return 0.1f * lit->longest_side();
    bool first = true;
    Bounds bounds;
    for (std::size_t i = 0; i < buffer.pixels(); ++i) {
        if (!is_surface(buffer.depth[i])) continue;
        const CameraRay ray =
            camera_ray(buffer.camera, static_cast<float>(i % buffer.width) + 0.5f,
                       static_cast<float>(i / buffer.width) + 0.5f, buffer.width, buffer.height);
        const glm::vec3 point = ray.origin + buffer.depth[i] * ray.direction;
        bounds.min = first ? point : glm::min(bounds.min, point);
        bounds.max = first ? point : glm::max(bounds.max, point);
        first = false;
    }
    const glm::vec3 size = bounds.size();
    return 0.1f * std::max({size.x, size.y, size.z});
}

ScreenSubject load_screen_subject(const ScreenInput& input, const CommonOptions& common) {
    if (input.file.empty()) throw Error(ExitCode::kUsage, "FILE is required: a scene or a G-buffer");
    ScreenSubject subject;
    const bool buffered = is_gbuffer(input.file);
    if (buffered) {
        for (const bool given : {input.eye.has_value(), input.target.has_value(), input.view.has_value(),
                                 !input.camera.empty(), input.sun.has_value()})
            if (given)
                throw Error(
                    ExitCode::kUsage,
                    input.file +
                        " is a G-buffer, whose camera is where it was and whose light is its radiance; "
                        "--eye, --target, --view, --camera and --sun are for scenes");
        ScreenCamera lens;
        lens.orthographic = input.orthographic.has_value();
        lens.half_height = lens.orthographic ? 0.5f * *input.orthographic
                                             : std::tan(0.5f * glm::radians(input.fov.value_or(kFov)));
        if (!(lens.half_height > 0))
            throw Error(ExitCode::kUsage, "--orthographic: a G-buffer's height is above 0");
        subject.buffer = read_gbuffer(input.file, input.fov || input.orthographic ? &lens : nullptr);
        subject.camera = "its own";
        if (!input.reference_scene.empty()) {
            subject.scene = imported(input.reference_scene, input.crease_degrees);
            subject.lit = std::make_unique<LitScene>(*subject.scene);
        }
    } else {
        if (!input.reference_scene.empty())
            throw Error(ExitCode::kUsage, "--scene goes with a G-buffer; " + input.file + " is a scene");
        const Size size = size_of(input.size);
        subject.scene = imported(input.file, input.crease_degrees);
        const auto start = std::chrono::steady_clock::now();
        subject.lit = std::make_unique<LitScene>(*subject.scene);
        const ScreenCamera camera =
            camera_for(input, *subject.scene, subject.lit->bounds(), size.aspect(), subject.camera);
        subject.lit->set_sun({input.sun ? vector_of(*input.sun) : default_sun(camera, vector_of(input.up)),
                              vector_of(input.sun_colour)});
        if (input.sun && vector_of(*input.sun) == glm::vec3(0))
            throw Error(ExitCode::kUsage, "--sun: 0 0 0 is no direction");
        subject.buffer =
            trace_gbuffer(*subject.lit, camera, size.width, size.height, vector_of(input.background),
                          common.threads, &subject.instances, &interrupted);
        subject.trace_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    if (surface_pixels(subject.buffer, 1).empty())
        std::fprintf(stderr, "dfield: %s: the camera sees no surface\n", input.file.c_str());
    return subject;
}

}  // namespace dfield::cli
