// The runtime as the command uses it: through its C ABI, with TBB behind the parallel_for hook.
#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "baker/scene.hpp"
#include "dfield/dfield.hpp"
#include "dfield/threads.hpp"

namespace dfield::cli {

// A context whose queries run on `threads` threads (0 = all cores). The object must outlive what is made from
// it.
class ThreadedContext {
  public:
    // `simd` caps the instruction set.
    explicit ThreadedContext(int threads, dfield_simd simd = DFIELD_SIMD_BEST);
    const Context& get() const { return context_; }

  private:
    std::unique_ptr<Threads> threads_;  // the hook's; outlives the context
    Context context_;
};

// "maps", "lines", "directions" or "volume", as --kind and reports spell it.
const char* name_of(dfield_kind kind);

// Points with normals where occlusion is asked for, world space.
struct Receivers {
    std::vector<glm::vec3> positions, normals;

    std::size_t size() const { return positions.size(); }
    // For the C ABI; `owners` may be empty.
    dfield_receivers view(std::span<const dfield_instance> owners = {}) const;
};

// Whether a mesh placed so can be looked up: it has triangles, and no scale of the transform is zero (glTF
// hides nodes by that).
bool casts(const TriangleMesh& mesh, const glm::mat4& transform);

// Adds to the report's warnings the nodes with triangles that do not cast.
void note_flat_nodes(ImportedScene& scene);

// A mesh's vertices placed in the world: normals by the inverse transpose, unit.
Receivers placed_vertices(const TriangleMesh& mesh, const glm::mat4& transform);

}  // namespace dfield::cli
