#include <bit>
#include <cmath>
#include <optional>

#include "baker/error.hpp"
#include "baker/import/openmesh_input.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {
namespace {

struct PlyType {
    char kind = 0;  // 'i' signed, 'u' unsigned, 'f' floating point; 0 = no type
    std::size_t size = 0;
};

struct PlyProperty {
    std::string name;
    PlyType type;        // of the value, or of a list's entries
    PlyType count_type;  // of a list's length; kind 0: no list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };

PlyType parse_type(const TextScanner& scan, std::string_view name) {
    static constexpr struct {
        std::string_view name;
        PlyType type;
    } kTypes[] = {{"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
                  {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
                  {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}},
                  {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}}};
    for (const auto& entry : kTypes)
        if (entry.name == name) return entry.type;
    scan.fail(quoted(name) + " is no PLY type (char ... uint, float, double)");
}

// Values of the body, one after the other, each checked against the end of the file.
class PlyValues {
  public:
    PlyValues(std::string file, TextScanner body, PlyEncoding encoding)
        : file_(std::move(file)), text_(std::move(body)), bytes_(text_.rest()), encoding_(encoding) {}

    bool is_text() const { return encoding_ == PlyEncoding::kText; }
    std::size_t bytes_left() const { return is_text() ? text_.bytes_left() + 1 : bytes_.size() - position_; }

    float number(PlyType type) {
        if (is_text()) return text_.number("a number");
        const double value = binary(type);
        return std::abs(value) < kNotFinite ? static_cast<float>(value) : kNotFinite;
    }
    // Nothing where the value is not a whole number.
    std::optional<std::int64_t> integer(PlyType type) {
        if (is_text()) return text_.integer("a whole number");
        const double value = binary(type);  // exact for all integers of up to 32 bits
        if (!(std::abs(value) < 1e15) || value != std::floor(value)) return std::nullopt;
        return static_cast<std::int64_t>(value);
    }
    void skip(PlyType type) {
        if (is_text())
            text_.token("a value");
        else
            binary(type);
    }
    [[noreturn]] void fail(const std::string& message) const {
        if (is_text()) text_.fail(message);
        throw InputError(file_ + ": byte " + std::to_string(position_) + " after the header: " + message);
    }

  private:
    double binary(PlyType type) {
        if (type.size > bytes_.size() - position_)
            fail("the file ends in the middle of its data: it is cut off or its counts are wrong");
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < type.size; ++i) {
            const std::size_t at = encoding_ == PlyEncoding::kBigEndian ? type.size - 1 - i : i;
            bits |= std::uint64_t{static_cast<unsigned char>(bytes_[position_ + at])} << (8 * i);
        }
        position_ += type.size;
        if (type.kind == 'f')
            return type.size == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                                  : std::bit_cast<double>(bits);
        if (type.kind == 'i' && (bits >> (8 * type.size - 1)) != 0)
            bits |= ~std::uint64_t{0} << (8 * type.size - 1);
        return static_cast<double>(static_cast<std::int64_t>(bits));
    }

    std::string file_;
    TextScanner text_;
    std::string_view bytes_;
    std::size_t position_ = 0;
    PlyEncoding encoding_;
};

class PlyReducer {
  public:
    PlyReducer(const std::string& file, std::string_view bytes) : file_(file), scan_(file, bytes, 0) {
        header();
    }

    OpenMeshInput reduce() {
        PlyValues values(file_, scan_, encoding_);
        for (const PlyElement& element : elements_) {
            check_count(values, element);
            if (element.name == "vertex")
                vertices(values, element);
            else if (element.name == "face")
                faces(values, element);
            else
                skip(values, element);
        }
        return make_ply(vertex_count_, normals_, vertex_bytes_, face_count_, face_bytes_);
    }

  private:
    void header() {
        if (scan_.token("the word ply") != "ply") scan_.fail("a PLY file starts with the line 'ply'");
        scan_.skip_line();
        bool format = false;
        for (;; scan_.skip_line()) {
            const std::string_view keyword = scan_.token("the line end_header");
            if (keyword == "end_header") break;
            if (keyword == "format") {
                const std::string_view name = scan_.token_on_line();
                if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
                    scan_.fail("the format is none of ascii, binary_little_endian, binary_big_endian");
                encoding_ = name == "ascii"                  ? PlyEncoding::kText
                            : name == "binary_little_endian" ? PlyEncoding::kLittleEndian
                                                             : PlyEncoding::kBigEndian;
                format = true;
            } else if (keyword == "element") {
                PlyElement& element = elements_.emplace_back();
                element.name = scan_.token_on_line();
                element.count = scan_.count("the count of an element");
            } else if (keyword == "property") {
                property();
            } else if (keyword != "comment" && keyword != "obj_info") {
                scan_.fail(quoted(keyword) + " is no line of a PLY header");
            }
        }
        scan_.skip_line();
        if (!format) scan_.fail("the header has no format line");
        for (const PlyElement& element : elements_) {
            if (element.name == "vertex") vertex_count_ += element.count;
            if (element.name == "tristrips")
                scan_.fail("triangle strips in PLY are not supported: export faces");
        }
    }

    void property() {
        if (elements_.empty()) scan_.fail("a property stands before the first element");
        PlyProperty property;
        std::string_view word = scan_.token_on_line();
        if (word == "list") {
            property.count_type = parse_type(scan_, scan_.token_on_line());
            if (property.count_type.kind == 'f') scan_.fail("a list's length must be of a whole-number type");
            word = scan_.token_on_line();
        }
        property.type = parse_type(scan_, word);
        property.name = scan_.token_on_line();
        elements_.back().properties.push_back(property);
    }

    // Before any memory is taken for it.
    void check_count(const PlyValues& values, const PlyElement& element) const {
        std::uint64_t least = 0;  // bytes of one element
        for (const PlyProperty& p : element.properties)
            least += values.is_text() ? 2 : (p.count_type.kind != 0 ? p.count_type.size : p.type.size);
        if (least * element.count > values.bytes_left())
            values.fail("the header promises " + std::to_string(element.count) + " elements '" +
                        element.name + "' of at least " + std::to_string(least) + " bytes, but only " +
                        std::to_string(values.bytes_left()) + " bytes follow");
    }

    std::uint64_t list_length(PlyValues& values, const PlyProperty& property) const {
        const std::optional<std::int64_t> length = values.integer(property.count_type);
        const std::uint64_t least = values.is_text() ? 2 : property.type.size;
        if (!length || *length < 0 || static_cast<std::uint64_t>(*length) > values.bytes_left() / least)
            values.fail("a list '" + property.name + "' promises more entries than the file can hold");
        return static_cast<std::uint64_t>(*length);
    }

    void skip(PlyValues& values, const PlyProperty& property) const {
        const std::uint64_t entries = property.count_type.kind != 0 ? list_length(values, property) : 1;
        for (std::uint64_t i = 0; i < entries; ++i) values.skip(property.type);
    }

    void skip(PlyValues& values, const PlyElement& element) const {
        if (element.properties.empty()) return;
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) skip(values, property);
    }

    void vertices(PlyValues& values, const PlyElement& element) {
        static constexpr std::string_view kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
        std::vector<int> slots;  // per property: where its number goes, -1 = nowhere
        std::uint32_t found = 0;
        for (const PlyProperty& property : element.properties) {
            int slot = -1;
            for (int i = 0; i < 6; ++i)
                if (property.name == kNames[i] && property.count_type.kind == 0) slot = i;
            if (slot >= 0) found |= 1u << slot;
            slots.push_back(slot);
        }
        if ((found & 7u) != 7u) values.fail("the vertices have no properties x, y and z");
        normals_ = (found & 0x38u) == 0x38u;
        vertex_bytes_.reserve((normals_ ? 24 : 12) * element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            float number[6] = {};
            for (std::size_t p = 0; p < slots.size(); ++p) {
                const PlyProperty& property = element.properties[p];
                if (slots[p] < 0)
                    skip(values, property);
                else
                    number[slots[p]] = values.number(property.type);
            }
            for (int k = 0; k < (normals_ ? 6 : 3); ++k) append_float(vertex_bytes_, number[k]);
        }
    }

    void faces(PlyValues& values, const PlyElement& element) {
        const auto is_outline = [](const PlyProperty& p) {
            return p.count_type.kind != 0 && (p.name == "vertex_indices" || p.name == "vertex_index");
        };
        int outlines = 0;
        for (const PlyProperty& property : element.properties) outlines += is_outline(property);
        if (outlines != 1)
            values.fail("the faces need one list 'vertex_indices', and have " + std::to_string(outlines));
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) {
                if (!is_outline(property)) {
                    skip(values, property);
                    continue;
                }
                const std::uint64_t corners = list_length(values, property);
                append_word(face_bytes_, static_cast<std::uint32_t>(corners));
                for (std::uint64_t k = 0; k < corners; ++k) {
                    const std::optional<std::int64_t> index = values.integer(property.type);
                    const bool inside =
                        index && *index >= 0 && *index < static_cast<std::int64_t>(vertex_count_);
                    append_word(face_bytes_, inside ? static_cast<std::uint32_t>(*index) : kNoVertex);
                }
            }
        face_count_ += element.count;
    }

    std::string file_;
    TextScanner scan_;
    PlyEncoding encoding_ = PlyEncoding::kText;
    std::vector<PlyElement> elements_;
    std::uint64_t vertex_count_ = 0, face_count_ = 0;
    bool normals_ = false;
    std::string vertex_bytes_, face_bytes_;
};

}  // namespace

OpenMeshInput reduce_ply(const std::string& file, std::string_view bytes) {
    return PlyReducer(file, bytes).reduce();
}

}  // namespace dfield
