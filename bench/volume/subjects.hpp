// The volumes that the chapter measures: the project's own, and CT scans that are no part of it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "baker/volume/volume.hpp"
#include "models/volumes.hpp"

namespace dfield::volumes {

struct Subject {
    std::string name;
    Volume volume;
    float isovalue = 0;
};

// Floats as they were made; the isovalue is 0.
Subject as_floats(std::string name, const models::ScalarVolume& values);
// Bytes, as scanners give them: 127.5 + scale * value, rounded and cut off; the isovalue is 127.5.
Subject as_bytes(std::string name, const models::ScalarVolume& values, double scale);
// With air around it, which is the least value: where matter reaches the border it gets a surface.
Subject padded(const Subject& subject, std::size_t voxels);
// The pictures' scenes, `size` voxels along each side, with air around them: the floor with boxes as a slab
// of its own, and a dense tangle of vessels.
inline constexpr std::uint32_t kAir = 4;
Subject slab_with_boxes(std::uint32_t size);
Subject tangled_vessels(std::uint32_t size);
// What times are measured on: a gyroid of bytes, six periods.
Subject timed_subject(models::Dims dims);
Subject timed_subject(std::uint32_t size);

inline constexpr double kGyroidPeriods = 6;

class Stock {
  public:
    // `shared` may be missing. `quick` shrinks everything to what a test can wait for, and leaves `shared`
    // alone.
    Stock(std::filesystem::path shared, bool quick) : shared_(std::move(shared)), quick_(quick) {}

    bool quick() const { return quick_; }
    std::uint32_t size(std::uint32_t full) const { return quick_ ? std::max(20u, full / 8) : full; }
    std::uint32_t pixels(std::uint32_t full) const { return quick_ ? full / 4 : full; }
    int rounds(int full) const { return quick_ ? 1 : full; }

    // Null, and noted as missing, where the file is not there.
    const Subject* shared(const std::string& name);
    static std::span<const char* const> shared_names();

  private:
    std::filesystem::path shared_;
    bool quick_;
    std::map<std::string, Subject> loaded_;
};

}  // namespace dfield::volumes
