// A volume as the runtime takes it, and a context of some threads for the calls.
#pragma once

#include <chrono>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "baker/volume/volume.hpp"
#include "dfield/dfield.hpp"
#include "dfield/threads.hpp"

namespace dfield::cli {

class RuntimeVolume {
  public:
    // `name` is the volume's in messages; the volume must outlive this. Throws InputError for too many
    // voxels.
    // `hooks` as for a context of its own; its parallel_for is that of `threads` where these are more than
    // one.
    RuntimeVolume(std::string name, const Volume& volume, int threads, dfield_context_desc hooks = {});

    const std::string& name() const { return name_; }
    int threads() const { return static_cast<int>(threads_ ? threads_->size() : 1); }
    std::size_t voxels() const { return voxels_; }
    const Context& context() const { return *context_; }
    const dfield_volume_samples& samples() const { return samples_; }

    // Returns the seconds that the call took. Throws InputError for what the runtime refuses, and
    // Error(kInterrupted) after Ctrl-C.
    template<class Call>
    double timed(const Call& call) const {
        const auto start = std::chrono::steady_clock::now();
        try {
            call();
        } catch (const Exception& error) {
            rethrow(error);
        }
        check_interrupted();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

  private:
    [[noreturn]] void rethrow(const Exception& error) const;
    static void check_interrupted();

    std::string name_;
    std::size_t voxels_;
    std::optional<Threads> threads_;  // none for one thread: what is computed then stays in the cache
    std::optional<Context> context_;
    std::vector<float> converted_;  // the voxels, where the runtime does not take their type
    dfield_volume_samples samples_{};
};

// On stderr, where they are not perpendicular: lengths are then measured as if they were.
void warn_of_oblique_axes(const std::string& name, const VolumeGrid& grid);

// From the world to the runtime's frame, where voxel (x, y, z) lies at (x, y, z) * spacing.
glm::dmat4 world_to_frame(const VolumeGrid& grid);

}  // namespace dfield::cli
