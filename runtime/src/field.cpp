#include "field.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "batch/field_levels.hpp"
#include "format/file.hpp"
#include "format/sphere_points.hpp"
#include "kind.hpp"
#include "status.hpp"

dfield_field::dfield_field(dfield_context* context, std::span<const std::byte> bytes,
                           const dfield::ReadOptions& options)
    : Shared(context),
      maps(dfield::read_field(bytes, options, context)),
      points(context),
      map_stride(dfield::map_bytes(maps.parameters)),
      hit_bits(context),
      self_visibility(context),
      line_points(context),
      direction_reach(context),
      level_disagreement(context) {
    const auto samples = dfield::sphere_points(maps.parameters.positions, maps.parameters.subdivision);
    points.assign(samples.begin(), samples.end());
    if (maps.parameters.bits == 8) {
        hit_bits.resize(points.size() * hit_stride());
        for (std::size_t map = 0; map < points.size(); ++map)
            for (std::size_t i = 0; i < map_stride; ++i)
                hit_bits[map * hit_stride() + i / 8] |=
                    static_cast<std::uint8_t>((maps.texels[map * map_stride + i] != dfield::kMiss8) << i % 8);
    }
    if (maps.lines && maps.lines->parameters.pivot) {
        const auto lattice = dfield::lattice_points(maps.lines->parameters.lattice);
        line_points.reserve(lattice.size());
        for (const glm::vec3& point : lattice) line_points.emplace_back(point, 0.0f);
    }
    for (const dfield::DirectionMaps& level : maps.directions)
        direction_reach.push_back(dfield::direction_reach(level));
    for (const dfield::DirectionMaps& level : maps.directions)
        level_disagreement.push_back(dfield::runtime::level_disagreement(level, maps.directions.back()));
    self_visibility.reserve(maps.self_visibility.size());
    for (const std::uint16_t value : maps.self_visibility)
        self_visibility.push_back(static_cast<float>(value) / 65535.0f);
    maps.self_visibility.clear();
    maps.self_visibility.shrink_to_fit();
}

std::uint64_t dfield_field::memory_bytes() const {
    std::uint64_t directions = 0;
    for (const dfield::DirectionMaps& level : maps.directions) directions += level.memory_bytes();
    return sizeof(*this) + maps.texels.capacity() + hit_bits.capacity() +
           maps.mean_depth.capacity() * sizeof(std::uint16_t) + points.capacity() * sizeof(glm::vec3) +
           self_visibility.capacity() * sizeof(float) + line_points.capacity() * sizeof(glm::vec4) +
           (maps.lines ? maps.lines->memory_bytes() : 0) + (maps.volume ? maps.volume->memory_bytes() : 0) +
           directions + maps.provenance.capacity();
}

namespace dfield::runtime {
namespace {

std::pmr::vector<std::byte> read_whole(const char* path, std::pmr::memory_resource* memory) {
    const std::filesystem::path name(reinterpret_cast<const char8_t*>(path));
    std::ifstream file(name, std::ios::binary | std::ios::ate);
    if (!file)
        throw Failure{DFIELD_FILE_ERROR,
                      std::string(path) + ": cannot be opened; check that it exists and can be read"};
    const std::streamoff size = file.tellg();
    if (size < 0) throw Failure{DFIELD_FILE_ERROR, std::string(path) + ": is no regular file"};
    std::pmr::vector<std::byte> bytes(static_cast<std::size_t>(size), memory);
    file.seekg(0);
    if (size > 0 && !file.read(reinterpret_cast<char*>(bytes.data()), size))
        throw Failure{DFIELD_FILE_ERROR, std::string(path) + ": reading failed"};
    return bytes;
}

std::uint32_t kinds_of(const dfield_field& field) {
    std::uint32_t kinds = 0;
    for (const dfield_kind kind :
         {DFIELD_KIND_MAPS, DFIELD_KIND_LINES, DFIELD_KIND_DIRECTIONS, DFIELD_KIND_VOLUME})
        kinds |= std::uint32_t{has_kind(field, kind)} << kind;
    return kinds;
}

void log_loaded(const dfield_field& field) {
    const std::uint32_t kinds = kinds_of(field);
    char line[160];
    std::snprintf(line, sizeof line, "field loaded: %llu bytes in memory;%s%s%s%s",
                  static_cast<unsigned long long>(field.memory_bytes()),
                  kinds >> DFIELD_KIND_MAPS & 1 ? " displacement maps" : "",
                  kinds >> DFIELD_KIND_LINES & 1 ? " line table" : "",
                  kinds >> DFIELD_KIND_DIRECTIONS & 1 ? " direction maps" : "",
                  kinds >> DFIELD_KIND_VOLUME & 1 ? " occlusion volume" : "");
    field.context()->log(DFIELD_LOG_INFO, line);
}

}  // namespace
}  // namespace dfield::runtime

extern "C" {

dfield_status dfield_field_load_memory(dfield_context* context, const void* bytes, size_t size,
                                       dfield_field** field) {
    return dfield::runtime::guarded([&] {
        using dfield::runtime::require;
        require(context && field, "dfield_field_load_memory: context or field is null");
        require(bytes || size == 0, "dfield_field_load_memory: bytes is null");
        *field = dfield_field::make(context, std::span(static_cast<const std::byte*>(bytes), size));
        dfield::runtime::log_loaded(**field);
    });
}

dfield_status dfield_field_load_part(dfield_context* context, const dfield_load_desc* desc, const void* bytes,
                                     size_t size, dfield_field** field) {
    return dfield::runtime::guarded([&] {
        using namespace dfield::runtime;
        require(context && desc && field, "dfield_field_load_part: context, desc or field is null");
        require(bytes || size == 0, "dfield_field_load_part: bytes is null");
        require(desc->struct_size == sizeof(dfield_load_desc),
                "dfield_field_load_part: desc->struct_size is not sizeof(dfield_load_desc)");
        const auto wanted = [&](dfield_kind kind) {
            return desc->kinds == 0 || (desc->kinds >> kind & 1) != 0;
        };
        dfield::ReadOptions options;
        options.maps = wanted(DFIELD_KIND_MAPS);
        options.lines = wanted(DFIELD_KIND_LINES);
        options.volume = wanted(DFIELD_KIND_VOLUME);
        if (desc->direction_levels != 0) options.direction_levels = desc->direction_levels;
        if (!wanted(DFIELD_KIND_DIRECTIONS)) options.direction_levels = 0;
        const std::span whole(static_cast<const std::byte*>(bytes), size);
        dfield_field* loaded = dfield_field::make(context, whole, options);
        if (kinds_of(*loaded) == 0) {
            loaded->release();
            require(false, "dfield_field_load_part: the file holds none of the wanted kinds");
        }
        log_loaded(*loaded);
        *field = loaded;
    });
}

dfield_status dfield_field_load_file(dfield_context* context, const char* path, dfield_field** field) {
    return dfield::runtime::guarded([&] {
        using namespace dfield::runtime;
        require(context && path && field, "dfield_field_load_file: context, path or field is null");
        const auto bytes = read_whole(path, context);
        try {
            *field = dfield_field::make(context, std::span<const std::byte>(bytes));
        } catch (const dfield::FormatError& error) {
            throw dfield::FormatError(error.code(), std::string(path) + ": " + error.what());
        }
        dfield::runtime::log_loaded(**field);
    });
}

void dfield_field_retain(dfield_field* field) {
    if (field) field->retain();
}

void dfield_field_release(dfield_field* field) {
    if (field) field->release();
}

dfield_status dfield_field_get_info(const dfield_field* field, dfield_field_info* info) {
    return dfield::runtime::guarded([&] {
        dfield::runtime::require(field && info, "dfield_field_get_info: field or info is null");
        const dfield::DisplacementField& maps = field->maps;
        dfield_field_info result{};
        result.positions = static_cast<std::uint32_t>(maps.parameters.positions);
        result.subdivision = maps.parameters.subdivision;
        result.position_count = static_cast<std::uint32_t>(field->points.size());
        result.mapping = static_cast<std::uint32_t>(maps.parameters.mapping);
        result.map_size = maps.parameters.map_size;
        result.bits = maps.parameters.bits;
        for (int axis = 0; axis < 3; ++axis) {
            result.centre[axis] = maps.centre[axis];
            result.bounds_min[axis] = maps.bounds_min[axis];
            result.bounds_max[axis] = maps.bounds_max[axis];
        }
        result.radius = maps.radius;
        result.memory_bytes = field->memory_bytes();
        result.self_vertex_count = field->self_visibility.size();
        result.kinds = dfield::runtime::kinds_of(*field);
        if (maps.lines) {
            result.line_lattice = maps.lines->parameters.lattice;
            result.line_depth_bits = maps.lines->parameters.depth_bits;
        }
        if (!maps.directions.empty()) {
            const dfield::DirectionParameters& finest = maps.directions.back().parameters;
            result.direction_levels = static_cast<std::uint32_t>(maps.directions.size());
            result.direction_count = dfield::direction_count(finest.subdivision);
            result.direction_map_size = finest.map_size;
            result.direction_depth_size = finest.depth_size;
        }
        if (maps.volume) {
            std::copy(maps.volume->dims.begin(), maps.volume->dims.end(), result.volume_dims);
            result.volume_spacing = maps.volume->spacing;
        }
        *info = result;
    });
}

const float* dfield_field_get_self_visibility(const dfield_field* field) {
    return field && !field->self_visibility.empty() ? field->self_visibility.data() : nullptr;
}
}
