// Fields baked for a test and loaded into the runtime through its public interface.
#pragma once

#include <vector>

#include "baker/bake.hpp"
#include "dfield/dfield.hpp"
#include "format/writer.hpp"

namespace dfield::test {

inline std::vector<std::byte> baked_bytes(const TriangleMesh& mesh, std::uint32_t n = 16,
                                          std::uint32_t m = 16, std::uint32_t bits = 8,
                                          Mapping mapping = Mapping::kConcentric,
                                          Positions positions = Positions::kSlater) {
    BakeOptions options;
    options.parameters = {positions, n, mapping, m, bits};
    return write_field(bake_field(mesh, options), {.zstd_level = 1});
}

inline Field baked(const Context& context, const TriangleMesh& mesh, std::uint32_t n = 16,
                   std::uint32_t m = 16, std::uint32_t bits = 8, Mapping mapping = Mapping::kConcentric,
                   Positions positions = Positions::kSlater) {
    const auto bytes = baked_bytes(mesh, n, m, bits, mapping, positions);
    return Field::load(context, bytes.data(), bytes.size());
}

inline constexpr float kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

}  // namespace dfield::test
