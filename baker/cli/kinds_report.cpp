#include "baker/cli/kinds_report.hpp"

#include "baker/cli/terminal.hpp"
#include "baker/provenance.hpp"
#include "format/layout.hpp"

namespace dfield::cli {
namespace {

std::uint64_t map_field_bytes(const DisplacementField& field) {
    return field.texels.size() + 2 * field.mean_depth.size();
}

std::uint64_t stored_bytes(const FileInfo& file, std::initializer_list<std::string_view> ids) {
    std::uint64_t bytes = 0;
    for (const SectionInfo& section : file.sections)
        for (const std::string_view id : ids)
            if (section.id == id) bytes += section.stored_bytes;
    return bytes;
}

std::uint64_t line_bytes(const LineTable& table) {
    return 4 * (table.hits.size() + table.depths.size());
}

std::uint64_t map_file_bytes(const FileInfo& file) {
    return stored_bytes(file, {layout::kMask, layout::kDistances, layout::kMeanDepth});
}

}  // namespace

std::uint64_t kinds_bytes(const DisplacementField& field) {
    std::uint64_t bytes = map_field_bytes(field);
    if (field.lines) bytes += line_bytes(*field.lines);
    for (const DirectionMaps& level : field.directions) bytes += level.memory_bytes();
    if (field.volume) bytes += field.volume->memory_bytes();
    return bytes;
}

Json kinds_json(const DisplacementField& field, const FileInfo& file) {
    Json kinds = Json::array();
    const FieldParameters& maps = field.parameters;
    if (has_maps(maps))
        kinds.push_back({{"kind", "maps"},
                         {"layout", name_of(maps.positions)},
                         {"subdivision", maps.subdivision},
                         {"positions", position_count(maps)},
                         {"mapping", name_of(maps.mapping)},
                         {"map_size", maps.map_size},
                         {"bits", maps.bits},
                         {"memory_bytes", map_field_bytes(field)},
                         {"file_bytes", map_file_bytes(file)}});
    if (field.lines) {
        const LineParameters& lines = field.lines->parameters;
        kinds.push_back({{"kind", "lines"},
                         {"line_size", lines.lattice},
                         {"points", lattice_point_count(lines.lattice)},
                         {"depth_bits", lines.depth_bits},
                         {"depth_size", lines.depth_lattice},
                         {"lookup", lookup_name(lines)},
                         {"space", lines.ellipsoid ? "ellipsoid" : "sphere"},
                         {"memory_bytes", line_bytes(*field.lines)},
                         {"file_bytes", stored_bytes(file, {layout::kLines})}});
    }
    for (std::size_t i = 0; i < field.directions.size(); ++i) {
        const DirectionParameters& level = field.directions[i].parameters;
        kinds.push_back({{"kind", "directions"},
                         {"level", i},
                         {"subdivision", level.subdivision},
                         {"directions", direction_count(level.subdivision)},
                         {"map_size", level.map_size},
                         {"depth_size", level.depth_size},
                         {"memory_bytes", field.directions[i].memory_bytes()},
                         {"file_bytes", stored_bytes(file, {layout::kDirectionLevels[i]})}});
    }
    if (field.volume) {
        const OcclusionVolume& volume = *field.volume;
        kinds.push_back({{"kind", "volume"},
                         {"dims", volume.dims},
                         {"spacing", volume.spacing},
                         {"far_size", volume.far_size},
                         {"memory_bytes", volume.memory_bytes()},
                         {"file_bytes", stored_bytes(file, {layout::kVolume})}});
    }
    return kinds;
}

std::vector<KindLine> kind_lines(const DisplacementField& field, const FileInfo& file) {
    std::vector<KindLine> lines;
    const auto sizes = [](std::uint64_t memory, std::uint64_t stored) {
        return ", " + bytes_text(memory) + " in memory, " + bytes_text(stored) + " in the file";
    };
    const FieldParameters& maps = field.parameters;
    if (has_maps(maps))
        lines.push_back(
            {"maps", text("%llu %s (subdivision %u; the paper counts %llu) of %ux%u %s, %u bit",
                          static_cast<unsigned long long>(position_count(maps)), name_of(maps.positions),
                          maps.subdivision, static_cast<unsigned long long>(paper_position_count(maps)),
                          maps.map_size, maps.map_size, name_of(maps.mapping), maps.bits) +
                         sizes(map_field_bytes(field), map_file_bytes(file))});
    if (field.lines) {
        const LineParameters& p = field.lines->parameters;
        std::string depths = "no depths";
        if (p.depth_bits != 0)
            depths = text("%u bit depths between %ux%u", p.depth_bits, p.depth_lattice, p.depth_lattice);
        lines.push_back(
            {"lines", text("chords between %ux%u points of the %s, %s lookup, %s", p.lattice, p.lattice,
                           p.ellipsoid ? "ellipsoid" : "sphere", lookup_name(p), depths.c_str()) +
                          sizes(line_bytes(*field.lines), stored_bytes(file, {layout::kLines}))});
    }
    for (std::size_t i = 0; i < field.directions.size(); ++i) {
        const DirectionParameters& p = field.directions[i].parameters;
        const std::string depths =
            p.depth_size == 0 ? "no depths" : text("%ux%u depths", p.depth_size, p.depth_size);
        lines.push_back({"directions", text("level %zu: %u directions (subdivision %u) of %ux%u, %s", i,
                                            direction_count(p.subdivision), p.subdivision, p.map_size,
                                            p.map_size, depths.c_str()) +
                                           sizes(field.directions[i].memory_bytes(),
                                                 stored_bytes(file, {layout::kDirectionLevels[i]}))});
    }
    if (field.volume) {
        const OcclusionVolume& volume = *field.volume;
        lines.push_back(
            {"volume", text("%ux%ux%u samples of 8 octants, %g apart; %ux%u balls beyond", volume.dims[0],
                            volume.dims[1], volume.dims[2], static_cast<double>(volume.spacing),
                            volume.far_size, volume.far_size) +
                           sizes(volume.memory_bytes(), stored_bytes(file, {layout::kVolume}))});
    }
    return lines;
}

}  // namespace dfield::cli
