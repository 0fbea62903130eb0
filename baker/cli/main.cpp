// The dfield command.
#include <cstdio>
#include <exception>
#include <new>

#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/terminal.hpp"

int main(int argc, char** argv) {
    using namespace dfield;
    CLI::App app(
        "Displacement fields: bakes what a rigid object hides into a small file, looks it up in constant "
        "time.\n",
        "dfield");
    app.set_version_flag("--version", "dfield " DFIELD_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Examples\n"
        "  dfield bake bunny.obj -o bunny.dfield          one model\n"
        "  dfield bake models/*.glb -o baked/             a folder of them; unchanged ones are skipped\n"
        "  dfield ao room.glb -o room-ao.glb              ambient occlusion at every vertex of a scene\n"
        "  dfield volume info brain.nii.gz                size, type and place of a volume\n"
        "  dfield volume sweep ct.nrrd --iso 500 -o ao.nrrd  ambient occlusion of its isosurface\n"
        "  dfield screen room.glb --indirect -o lit.png   occlusion and indirect light in screen space\n"
        "  dfield compare --caster bunny.obj --image c.png  lookup against ray casting, numbers and "
        "pictures\n"
        "\n"
        "Exit codes: 0 done; 1 internal error; 2 wrong usage; 3 an input cannot be read; 4 an output cannot "
        "be\n"
        "written; 5 some models of a batch failed; 6 validate found errors; 130 interrupted. Errors go to "
        "stderr.\n"
        "Sizes are in bytes, K = 1024.");
    ExitCode exit_code = ExitCode::kOk;
    cli::add_bake_command(app, exit_code);
    cli::add_info_command(app, exit_code);
    cli::add_validate_command(app, exit_code);
    cli::add_ao_command(app, exit_code);
    cli::add_compare_command(app, exit_code);
    cli::add_volume_command(app, exit_code);
    cli::add_screen_command(app, exit_code);
    cli::install_interrupt_handler();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
    } catch (const Error& error) {
        std::fprintf(stderr, "dfield: %s\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        std::fputs("dfield: out of memory; lower --subdivision or --map-size, or take a smaller volume\n",
                   stderr);
        return static_cast<int>(ExitCode::kInternal);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "dfield: internal error: %s\n", error.what());
        return static_cast<int>(ExitCode::kInternal);
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {  // now, or long ago
        std::fputs("dfield: standard output could not be written\n", stderr);
        return static_cast<int>(ExitCode::kOutput);
    }
    return static_cast<int>(exit_code);
}
