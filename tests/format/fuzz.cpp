// Seeded mutations behind right checksums: never a crash, never more memory than FORMAT.md states, never a
// field that breaks a rule.
#include <catch2/catch.hpp>

#include <map>

#include "format/codec.hpp"
#include "format/writer.hpp"
#include "tests/format/counting_memory.hpp"
#include "tests/format/fields.hpp"
#include "tests/format/file_editor.hpp"
#include "tests/format/kinds.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr ReadLimits kSmallLimits{.max_texel_bytes = 1 << 14,
                                  .max_self_vertices = 1 << 10,
                                  .max_line_bytes = 1 << 12,
                                  .max_direction_bytes = 1 << 13,
                                  .max_volume_bytes = 1 << 11};

// FORMAT.md, "Memory": with P <= 2 T, N <= T and E <= X that is below this for every field within the limits.
constexpr std::uint64_t kSmallBound =
    22 * kSmallLimits.max_texel_bytes + 4 * kSmallLimits.max_self_vertices +
    2 * (kSmallLimits.max_line_bytes + kSmallLimits.max_direction_bytes + kSmallLimits.max_volume_bytes) +
    kMaxProvenanceBytes + (256 << 10);

void mutate_bytes(Bits& random, Bytes& bytes) {
    static constexpr std::uint8_t kInteresting[] = {0, 1, 2, 0x7f, 0x80, 0xfe, 0xff};
    for (std::uint32_t k = 0; k <= random.below(3) && !bytes.empty(); ++k) {
        const std::size_t at = random.below(bytes.size());
        switch (random.below(6)) {
            case 0:
                bytes[at] ^= static_cast<std::byte>(1 << random.below(8));
                break;
            case 1:
                bytes[at] = static_cast<std::byte>(random.next());
                break;
            case 2:
                bytes[at] = std::byte{kInteresting[random.below(std::size(kInteresting))]};
                break;
            case 3:
                bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
                break;
            case 4:
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                             static_cast<std::byte>(random.next()));
                break;
            default:  // a whole word
                if (bytes.size() >= 4)
                    store_le(&bytes[at < bytes.size() - 4 ? at / 4 * 4 : 0],
                             static_cast<std::uint32_t>(
                                 random.below(3) == 0 ? ~0u : random.next() >> random.below(64)));
        }
    }
}

// One file with something wrong in it.
Bytes mutated(Bits& random, const FileEditor& source, const Bytes& bytes) {
    if (random.below(4) == 0) {  // header, table, padding, frames
        Bytes changed = bytes;
        const std::size_t head = layout::kHeaderBytes + source.sections.size() * layout::kEntryBytes;
        const std::size_t at =
            layout::kMajorAt +
            random.below((random.below(2) == 0 ? head : changed.size()) - layout::kMajorAt);
        changed[at] = static_cast<std::byte>(random.below(2) == 0 ? random.next() : 1 << random.below(8));
        seal(changed);
        return changed;
    }
    FileEditor editor = source;
    auto& section = editor.sections[random.below(editor.sections.size())];
    switch (random.below(14)) {
        case 0:
            std::swap(section, editor.sections[random.below(editor.sections.size())]);
            break;
        case 1:
            editor.sections.push_back(FileEditor::Section(section));
            break;
        case 2:
            editor.erase(section.id);
            break;
        case 3:
            section.frame = zstd_frame(section.raw);
            section.raw_bytes = section.raw.size();
            mutate_bytes(random, section.frame);
            break;
        case 4:
            section.frame = zstd_frame(section.raw);
            section.raw_bytes = random.next() >> random.below(64);
            break;
        case 5:
            std::swap(section.raw, editor.sections[random.below(editor.sections.size())].raw);
            break;
        default:
            mutate_bytes(random, section.raw);
    }
    return editor.build();
}

}  // namespace

TEST_CASE("mutated files are refused, or are fields") {
    struct Source {
        Bytes bytes;
        FileEditor editor;
    };
    std::vector<Source> sources;
    for (const std::uint32_t bits : {1u, 8u, 16u, 32u}) {
        const Mapping mapping = bits == 16 ? Mapping::kRejection : Mapping::kConcentric;
        DisplacementField field = make_field({Positions::kSlater, 1, mapping, 5, bits}, Pattern::kSmooth);
        add_optional_sections(field);
        Bytes bytes = write_field(field, {.zstd_level = 1});
        FileEditor editor(bytes);
        sources.push_back({std::move(bytes), std::move(editor)});
    }
    DisplacementField kinds = make_all_kinds_and_volume(1);
    for (int i = 0; i < 2; ++i) {  // twice as often as the others
        Bytes bytes = write_field(kinds, {.zstd_level = 1});
        FileEditor editor(bytes);
        sources.push_back({std::move(bytes), std::move(editor)});
        kinds.parameters = kNoMaps;
        kinds.texels.clear();
        kinds.mean_depth.clear();
    }
    Bits random(20);
    std::map<std::string_view, int> outcomes;
    CountingMemory memory;
    for (int i = 0; i < 30000; ++i) {
        const Source& source = sources[static_cast<std::size_t>(i) % sources.size()];
        const ExactCopy bytes(mutated(random, source.editor, source.bytes));
        memory.reset_peak();
        try {
            const DisplacementField field = read_field(bytes, {kSmallLimits}, &memory);
            ++outcomes["accepted"];
            REQUIRE_NOTHROW(write_field(field, {.zstd_level = 1}));
        } catch (const FormatError& error) {
            ++outcomes[format_error_name(error.code())];
        }
        REQUIRE(memory.peak() <= kSmallBound);
        if (i % 16 == 0) validate_file(bytes, kSmallLimits);
    }
    CHECK(memory.live() == 0);
    CHECK(outcomes["unknown"] == 0);
    // The mutations get to all stages.
    for (const char* stage :
         {"accepted",        "version",         "section-count",     "section-flags",    "section-order",
          "section-unknown", "section-missing", "section-placement", "section-padding",  "section-raw-size",
          "section-frame",   "reserved",        "parameters",        "memory-limit",     "not-finite",
          "radius",          "bounds",          "hit-mask",          "distances",        "provenance",
          "payload-hash",    "line-table",      "direction-maps",    "direction-levels", "volume"}) {
        INFO(stage);
        CHECK(outcomes[stage] > 0);
    }
}

TEST_CASE("reading takes no more memory than FORMAT.md states") {
    for (const std::uint32_t bits : {1u, 8u, 16u, 32u})
        for (const std::uint32_t m : {1u, 2u, 9u, 32u})
            for (const Pattern pattern : {Pattern::kSmooth, Pattern::kNoise, Pattern::kAllHit}) {
                const FieldParameters p{Positions::kSlater, 6, Mapping::kConcentric, m, bits};
                DisplacementField field = make_field(p, pattern);
                add_optional_sections(field);
                const Bytes bytes = write_field(field, {.zstd_level = 1});
                CountingMemory memory;
                {
                    const DisplacementField read = read_field(bytes, {}, &memory);
                    REQUIRE(same_field(read, field));
                    CHECK(memory.live() >= field.texels.size());  // the field comes from the caller's memory
                }
                const std::uint64_t t = texel_bytes(p), plane = codec::plane_bytes(p), n = position_count(p);
                CHECK(memory.peak() <= 2 * t + 2 * plane + 16 * n + 4 * field.self_visibility.size() +
                                           field.provenance.size() + (256 << 10));
                CHECK(memory.live() == 0);
            }
    for (const Pattern pattern : {Pattern::kSmooth, Pattern::kNoise, Pattern::kAllHit}) {
        DisplacementField field = make_empty_field();
        field.lines = make_line_table(line_parameters(16, 8, 9), pattern);
        std::uint64_t content = 4 * (field.lines->hits.size() + field.lines->depths.size());
        for (const DirectionParameters& p : {DirectionParameters{2, 16, 8}, DirectionParameters{6, 64, 16}}) {
            field.directions.push_back(make_direction_maps(p, pattern));
            content += field.directions.back().memory_bytes();
        }
        field.volume = make_volume({20, 11, 13}, 9, pattern);
        content += field.volume->memory_bytes();
        const Bytes bytes = write_field(field, {.zstd_level = 1});
        std::uint64_t largest = 0;
        for (const SectionInfo& section : read_file_info(bytes).sections)
            largest = std::max(largest, section.raw_bytes);
        CountingMemory memory;
        CHECK(same_kinds(read_field(bytes, {}, &memory), field));
        CHECK(memory.peak() <= content + largest + (256 << 10));
        CHECK(memory.live() == 0);
    }
}
