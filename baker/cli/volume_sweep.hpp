// Sweeping a volume from the command line: the flags, and the runtime behind them.
#pragma once

#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/runtime_volume.hpp"

namespace dfield::cli {

// How visibility is swept, by the names that flags and reports have for it.
struct SweepForm {
    const char* name;
    dfield_occlusion_form form;
    std::uint32_t ordinates;  // of the improved form
};
inline constexpr SweepForm kSweepForms[] = {{"improved", DFIELD_FORM_IMPROVED, 24},
                                            {"improved-48", DFIELD_FORM_IMPROVED, 48},
                                            {"paper", DFIELD_FORM_PAPER, 24},
                                            {"combined", DFIELD_FORM_COMBINED, 24}};

// --iso, required.
void add_isovalue_option(CLI::App& command, float& isovalue);

// --form --octants --intensity --gamma --alpha
struct SweepOptions {
    std::string form = kSweepForms[0].name, octants, intensity;
    float gamma = 1, alpha = 1;
};
void add_sweep_options(CLI::App& command, SweepOptions& options);

// What they say, and the form by its name. Call after parsing. Throws Error of usage.
dfield_sweep_desc sweep_desc(SweepOptions& options, float isovalue);
void set_form(dfield_sweep_desc& desc, const SweepForm& form);

// A direction of the world as one of the grid's own frame, where voxel (x, y, z) lies at (x, y, z) * spacing,
// which is the frame that the runtime sweeps in: straight lines are mapped to straight lines whether the
// directions are rotated, mirrored or oblique. The length is kept only by the former two.
glm::vec3 to_sweep_frame(const VolumeGrid& grid, const glm::vec3& direction);

// A volume as the runtime sweeps it.
class VolumeSweeper {
  public:
    // `name` is the volume's in messages; the volume must outlive this. Warns on stderr of directions that
    // are not perpendicular. Throws Error of usage where no voxel is on the one or on the other side of the
    // isovalue. `hooks` as for a context of its own; its parallel_for is that of `threads` where these are
    // more than one.
    VolumeSweeper(std::string name, const Volume& volume, float isovalue, int threads,
                  dfield_context_desc hooks = {});

    int threads() const { return volume_.threads(); }
    std::size_t voxels() const { return volume_.voxels(); }
    // Calls about fields on the volume's grid.
    VolumeField field(const float* distance) const { return {volume_.context(), grid(), distance}; }
    const dfield_volume_grid& grid() const { return volume_.samples().grid; }

    // Returns the seconds that the call took. Throws InputError for what cannot be swept, and
    // Error(kInterrupted) after Ctrl-C.
    double sweep(const dfield_sweep_desc& desc, const dfield_sweep_outputs& outputs) const;

  private:
    RuntimeVolume volume_;
};

}  // namespace dfield::cli
