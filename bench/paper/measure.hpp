// Errors in grey levels, and times that a busy machine does not spoil: the contestants take turns and each
// one's fastest turn counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/paper/lab.hpp"

namespace dfield::paper {

// Of `visibility` minus `reference`, times 255.
struct Errors {
    double rms = 0, bias = 0, max = 0;
};
Errors errors_of(const std::vector<float>& visibility, const std::vector<float>& reference);

// Receivers lit by lookup past one caster, through the runtime's C ABI, on one core.
class Lookup {
  public:
    // `reach` as in Lab::ray_cast.
    Lookup(std::span<const std::byte> field, const Receivers& receivers, const Directions& directions,
           float reach = kUnbounded);

    // Seconds of one whole run: rays made, looked up and counted.
    double run();
    double fastest_run(int rounds);

    const std::vector<float>& visibility() const { return visibility_; }  // after a run
    std::uint64_t memory_bytes() const { return field_.info().memory_bytes; }

  private:
    const Receivers& receivers_;
    cli::ThreadedContext context_{1};
    Field field_;
    Scene scene_;
    std::unique_ptr<Ao> ao_;
    std::vector<float> visibility_;
};

// The corner lit past a model with one core, by lookup and by Embree in all its modes: any-hit queries
// against the caster alone, high build quality, packets prepared beforehand, build not counted.
struct Duel {
    std::size_t rays = 0;
    double lookup_seconds = 0, embree_seconds = 0;
    std::string embree_mode;

    double speedup() const { return embree_seconds / lookup_seconds; }
};
Duel duel(const TriangleMesh& caster, std::span<const std::byte> field, const Receivers& receivers,
          const Directions& directions, int rounds);

}  // namespace dfield::paper
