#include "baker/cli/volume_input.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "baker/cli/arguments.hpp"
#include "baker/error.hpp"

namespace dfield::cli {
namespace {

constexpr const char* kGroup = "Raw volumes";

// "256x256x128"
template<class Number>
std::optional<std::array<Number, 3>> parse_triple(std::string_view text) {
    std::array<Number, 3> values{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::size_t i = 0; i < 3; ++i) {
        if (i > 0 && (at == end || (*at != 'x' && *at != 'X'))) return std::nullopt;
        const auto [next, error] = std::from_chars(at + (i > 0 ? 1 : 0), end, values[i]);
        if (error != std::errc()) return std::nullopt;
        at = next;
    }
    if (at != end) return std::nullopt;
    return values;
}

Json triple_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

void add_volume_input(CLI::App& command, VolumeInput& input) {
    command.add_option("FILE", input.file, "A volume: .nrrd, .nhdr, .nii, .nii.gz, .hdr/.img, or raw voxels")
        ->required();
    CLI::Option* dims =
        command
            .add_option("--dims", input.dims,
                        "The file holds raw voxels and nothing else, so many along x (fastest), y and z")
            ->type_name("NXxNYxNZ")
            ->group(kGroup);
    std::vector<std::string> types;
    for (const VoxelType type : kVoxelTypes) types.emplace_back(name_of(type));
    CLI::Option* type = command.add_option("--type", input.type, "Type of raw voxels")
                            ->check(CLI::IsMember(types))
                            ->group(kGroup);
    dims->needs(type);
    type->needs(dims);
    command.add_option("--spacing", input.spacing, "World units from a raw voxel to the next; default 1x1x1")
        ->type_name("SXxSYxSZ")
        ->needs(dims)
        ->group(kGroup);
    command
        .add_option_function<std::string>(
            "--endian",
            [&input](const std::string& name) {
                input.endian = name == "big" ? std::endian::big : std::endian::little;
            },
            "Byte order of raw voxels")
        ->default_str("little")
        ->transform(CLI::IsMember({"little", "big"}, CLI::ignore_case))
        ->needs(dims)
        ->group(kGroup);
    command.add_option("--header-bytes", input.header_bytes, "Bytes before the first raw voxel")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber)  // CLI11 reads -1 as 2^64 - 1
        ->needs(dims)
        ->group(kGroup);
}

VolumeReadOptions volume_read_options(const VolumeInput& input) {
    VolumeReadOptions options;
    if (input.dims.empty()) return options;
    RawLayout& layout = options.raw.emplace();
    const auto dims = parse_triple<std::size_t>(input.dims);
    if (!dims || (*dims)[0] == 0 || (*dims)[1] == 0 || (*dims)[2] == 0)
        throw Error(ExitCode::kUsage, "--dims: '" + input.dims + "' is no size such as 256x256x128");
    layout.size = *dims;
    for (const VoxelType type : kVoxelTypes)
        if (input.type == name_of(type)) layout.type = type;
    if (!input.spacing.empty()) {
        const auto spacing = parse_triple<double>(input.spacing);
        for (std::size_t i = 0; i < 3; ++i)
            if (!spacing || !std::isfinite((*spacing)[i]) || !((*spacing)[i] > 0))
                throw Error(ExitCode::kUsage,
                            "--spacing: '" + input.spacing + "' are no numbers above 0 such as 1x1x2.5");
        layout.spacing = {(*spacing)[0], (*spacing)[1], (*spacing)[2]};
    }
    layout.endian = input.endian;
    layout.header_bytes = input.header_bytes;
    return options;
}

Volume read_volume_input(const VolumeInput& input) {
    std::vector<std::string> warnings;
    Volume volume = read_volume(input.file, volume_read_options(input), &warnings);
    for (const std::string& warning : warnings) std::fprintf(stderr, "dfield: %s\n", warning.c_str());
    return volume;
}

Json volume_json(const VolumeInput& input, const Volume& volume) {
    const VolumeGrid& grid = volume.grid;
    Json json;
    json["file"] = input.file;
    json["format"] = volume_format(input.file, volume_read_options(input));
    json["dims"] = grid.size;
    json["type"] = name_of(volume.type);
    json["voxels"] = grid.voxels();
    json["spacing"] = triple_json(grid.spacing());
    json["origin"] = triple_json(grid.origin);
    json["directions"] = Json::array();
    for (int axis = 0; axis < 3; ++axis) json["directions"].push_back(triple_json(grid.directions[axis]));
    json["space"] = grid.space;
    json["unit"] = grid.unit;
    json["right_handed"] = grid.right_handed();
    return json;
}

}  // namespace dfield::cli
