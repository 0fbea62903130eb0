// `dfield screen`: occlusion and indirect light of a picture, from its depth alone.
#include "baker/cli/command_screen.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/screen_far.hpp"
#include "baker/cli/screen_options.hpp"
#include "baker/cli/screen_picture.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield::cli {
namespace {

struct ScreenCommand {
    ScreenInput input;
    ScreenOptions options;
    FarOptions far;
    ReferenceOptions reference;
    std::string output, gbuffer, reference_picture, show = "auto";
    bool indirect = false, derive_normals = false;
    int repetitions = 5;
    CommonOptions common;
};

void check_command(ScreenCommand& command) {
    if (command.output.empty() && command.gbuffer.empty() && command.common.json.empty())
        throw Error(ExitCode::kUsage, "give -o PICTURE.png, --gbuffer or --json: nothing else comes out");
    check_picture(command.output);
    check_picture(command.reference_picture);
    if (!command.gbuffer.empty()) {
        if (!is_gbuffer(command.gbuffer))
            throw Error(ExitCode::kUsage,
                        command.gbuffer + ": G-buffers are .exr, or .json with PNGs beside it");
        check_output(command.gbuffer);
    }
    if (command.show == "auto") command.show = command.indirect ? "lit" : "visibility";
    if (command.show == "indirect" || command.show == "lit") command.indirect = true;
}

// What fields add, and how much better that is than either alone.
Json far_json(const ScreenCommand& command, const ScreenRunner& runner, const ScreenShading& shading,
              const FarVisibility& far, const RayReference& world) {
    Json json{{"field", command.far.field}, {"rays", command.far.rays}, {"ms", significant(far.ms)}};
    const auto error = [&](const char* name, const std::vector<float>& frame) {
        json[name] =
            world.sky.empty() ? Json() : Json(significant(rms_grey(runner.at_pixels(frame), world.sky)));
    };
    error("rms_grey_combined", combined(shading.visibility, far.beyond));
    error("rms_grey_screen_alone", shading.visibility);
    error("rms_grey_field_alone", far.all);
    // What counts occluders within the radius twice.
    std::vector<float> product(far.all.size());
    for (std::size_t i = 0; i < product.size(); ++i) product[i] = far.all[i] * shading.visibility[i];
    error("rms_grey_product", product);
    return json;
}

void run(ScreenCommand& command) {
    check_command(command);
    ScreenSubject subject = load_screen_subject(command.input, command.common);
    if (command.indirect && subject.buffer.radiance.empty())
        throw InputError(command.input.file + ": has no radiance, which indirect light is made of");
    if (!command.reference_picture.empty() && !subject.lit)
        throw Error(ExitCode::kUsage, "--reference-picture needs a scene; give --scene");
    GBuffer seen;
    if (!command.gbuffer.empty()) seen = subject.buffer;
    if (command.derive_normals) subject.buffer.normals.clear();

    const ScreenRunner runner(subject, command.common.threads, command.reference);
    const dfield_screen_desc desc = screen_desc(command.options, subject.default_radius());
    ScreenShading shading = runner.shade(desc, command.indirect, command.repetitions);
    const bool far_wanted = !command.far.field.empty();
    std::optional<FarVisibility> far;
    if (far_wanted) far = far_visibility(command.far, subject, runner, desc, command.common);

    Json json = screen_json(command.input, subject, desc);
    json["indirect"] = command.indirect;
    json["threads"] = thread_count_of(command.common);
    json["ms"] = significant(shading.ms);
    json["mpixels_per_s"] = significant(mpixels_per_s(runner.buffer(), shading.ms));
    json["reference_pixels"] = runner.pixels().size();
    std::vector<glm::vec3> indirect;
    const std::vector<float> integral = runner.integral(desc, command.indirect ? &indirect : nullptr);
    const RayReference world = runner.by_rays(desc, command.indirect, far_wanted);
    const bool has_world = subject.lit != nullptr;
    json["rms_grey_screen"] = significant(rms_grey(runner.at_pixels(shading.visibility), integral));
    json["rms_grey_world"] =
        has_world ? Json(significant(rms_grey(runner.at_pixels(shading.visibility), world.visibility)))
                  : Json();
    json["rms_grey_screen_to_world"] =
        has_world ? Json(significant(rms_grey(integral, world.visibility))) : Json();
    if (command.indirect) {
        const std::vector<glm::vec3> at = runner.at_pixels(shading.indirect);
        json["rms_grey_indirect_screen"] = significant(rms_grey(at, indirect));
        // The light of a G-buffer's radiance is not that of the reference's sun.
        const bool same_light = has_world && !is_gbuffer(command.input.file);
        json["rms_grey_indirect_world"] =
            same_light ? Json(significant(rms_grey(at, world.indirect))) : Json();
    }
    const auto error_text = [&](const char* name) {
        return json[name].is_null() ? std::string("-") : text("%.2f", json[name].get<double>());
    };
    say(command.common.json,
        text("%s: %u x %u pixels, %s, R %.4g, %u samples: %.2f ms, %.1f M pixels/s",
             command.input.file.c_str(), runner.buffer().width, runner.buffer().height,
             name_of(static_cast<dfield_screen_estimator>(desc.estimator)), static_cast<double>(desc.radius),
             desc.samples, shading.ms, mpixels_per_s(runner.buffer(), shading.ms)));
    say(command.common.json, "RMS error in grey levels: " + error_text("rms_grey_screen") +
                                 " to the screen-space integral, " + error_text("rms_grey_world") +
                                 " to rays in world space");
    if (far) {
        json["far"] = far_json(command, runner, shading, *far, world);
        say(command.common.json, text("with %s: %.1f ms more", command.far.field.c_str(), far->ms));
        shading.visibility = combined(shading.visibility, far->beyond);
    }
    ScreenShading rays;
    if (!command.reference_picture.empty())
        rays.visibility = runner.picture_by_rays(desc, command.reference.rays, far_wanted);

    // Nothing before everything is there: Ctrl-C leaves no files.
    if (!command.gbuffer.empty()) write_gbuffer(command.gbuffer, seen);
    if (!command.output.empty())
        write_png(command.output,
                  screen_picture(command.show, runner.buffer(), shading,
                                 {vector_of(command.options.ambient), vector_of(command.input.background)}));
    if (!command.reference_picture.empty())
        write_png(command.reference_picture, screen_picture("visibility", runner.buffer(), rays, {}));
    if (!command.output.empty()) json["image"] = command.output;
    if (!command.gbuffer.empty()) json["gbuffer"] = command.gbuffer;
    write_json_report(command.common.json, json);
}

}  // namespace

void add_screen_command(CLI::App& app, ExitCode&) {
    auto command = std::make_shared<ScreenCommand>();
    command->common.threads = 1;
    CLI::App* screen = app.add_subcommand(
        "screen", "Ambient occlusion and indirect light in screen space, from depth and normals alone");
    add_screen_input(*screen, command->input);
    screen->add_option("-o,--output", command->output, "The picture, a PNG");
    screen
        ->add_option("--show", command->show,
                     "visibility, indirect, classic (direct light and ambient light as if all were open), "
                     "ambient (the same times visibility) or lit (indirect light too); auto: visibility, "
                     "with --indirect lit")
        ->capture_default_str()
        ->transform(
            CLI::IsMember({"auto", "visibility", "indirect", "classic", "ambient", "lit"}, CLI::ignore_case));
    screen->add_flag("--indirect", command->indirect, "Light from the neighbourhood too: colours bleed");
    screen->add_option("--gbuffer", command->gbuffer,
                       "Also write what the camera sees: .exr, or .json with PNGs beside it");
    screen->add_option("--reference-picture", command->reference_picture,
                       "Also a PNG of visibility by --reference-rays through the scene at every pixel; with "
                       "--field at any distance");
    screen->add_flag("--derive-normals", command->derive_normals, "From depth, whatever normals there are");
    add_screen_options(*screen, command->options, true);
    add_far_options(*screen, command->far);
    add_reference_options(*screen, command->reference);
    screen->add_option("--repetitions", command->repetitions, "Timed runs; the fastest counts")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    add_common_options(*screen, command->common, "1");
    CLI::App* compare = add_screen_compare_command(*screen);
    screen->footer(
        "ms is from buffers to result, the fastest of --repetitions. Errors leave out the sky and are in "
        "grey "
        "levels,\n"
        "0 to 255: rms_grey_screen against the screen-space integral that the estimator converges to, by "
        "brute "
        "force,\n"
        "rms_grey_world against the same integral by rays through the scene. Pictures are written without a "
        "transfer curve.");
    screen->callback([command, screen, compare] {
        if (!screen->got_subcommand(compare)) run(*command);
    });
}

}  // namespace dfield::cli
