#include <algorithm>
#include <array>
#include <optional>

#include "baker/import/openmesh_input.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {
namespace {

struct ObjCorner {
    std::uint32_t vertex = kNoVertex, normal = kNoVertex;  // from 0
};

// "7", "-1", "+2" against the number of elements so far. Forward references are allowed, as everywhere.
std::uint32_t resolve(std::int64_t index, std::uint64_t so_far) {
    if (index < 0) index += static_cast<std::int64_t>(so_far) + 1;
    return index >= 1 && index <= 0x7fffffff ? static_cast<std::uint32_t>(index - 1) : kNoVertex;
}

class ObjReducer {
  public:
    ObjReducer(const std::string& file, std::string_view bytes) : scan_(file, bytes, '#') {
        result_.extension = "obj";
        result_.bytes.reserve(bytes.size());
    }

    OpenMeshInput reduce() {
        while (!scan_.at_end()) {
            const std::string_view keyword = scan_.token_on_line();
            if (keyword == "v") {
                vector("v", "a coordinate of a vertex");
                ++result_.vertices;
            } else if (keyword == "vn") {
                vector("vn", "a coordinate of a normal");
                ++normals_;
            } else if (keyword == "f" || keyword == "fo") {
                face();
            } else if (keyword == "l" || keyword == "p") {
                ++result_.skipped;
            }
            scan_.skip_line();
        }
        return std::move(result_);
    }

  private:
    void vector(const char* keyword, const char* what) {
        result_.bytes += keyword;
        for (int i = 0; i < 3; ++i) {
            const std::string_view token = scan_.token_on_line();
            const std::optional<float> value = parse_float(token);
            if (!value) scan_.fail("expected " + std::string(what) + ", found " + quoted(token));
            append_number(result_.bytes, *value);
        }
        result_.bytes += '\n';
    }

    ObjCorner corner(std::string_view token) const {
        // v, v/vt, v//vn or v/vt/vn
        std::array<std::string_view, 3> part;
        for (int i = 0; i < 3; ++i) {
            const std::size_t slash = std::min(token.find('/'), token.size());
            part[static_cast<std::size_t>(i)] = token.substr(0, slash);
            token.remove_prefix(std::min(slash + 1, token.size()));
        }
        const std::optional<std::int64_t> vertex = parse_integer(part[0]), normal = parse_integer(part[2]);
        const bool huge = part[0].find_first_not_of("+-0123456789") == std::string_view::npos;
        if (!vertex && (part[0].empty() || !huge))
            scan_.fail("a face's corner is 'v', 'v/vt', 'v//vn' or 'v/vt/vn' with whole numbers");
        ObjCorner result;
        if (vertex) result.vertex = resolve(*vertex, result_.vertices);
        if (normal) result.normal = resolve(*normal, normals_);
        return result;
    }

    void face() {
        corners_.clear();
        for (std::string_view token = scan_.token_on_line(); !token.empty(); token = scan_.token_on_line())
            corners_.push_back(corner(token));
        order_.clear();
        for (const ObjCorner& c : corners_) order_.push_back(c.vertex);
        std::sort(order_.begin(), order_.end());
        const bool repeated = std::adjacent_find(order_.begin(), order_.end()) != order_.end();
        if (repeated || corners_.size() < 3) {
            std::vector<std::uint32_t>& other = result_.other_faces.emplace_back();
            for (const ObjCorner& c : corners_) other.push_back(c.vertex);
            return;
        }
        ++result_.faces;
        result_.bytes += 'f';
        for (const ObjCorner& c : corners_) {
            append_number(result_.bytes, c.vertex == kNoVertex ? 0 : c.vertex + 1);  // 0 is no index in OBJ
            if (c.normal == kNoVertex) continue;
            result_.bytes += '/';
            result_.bytes += '/';
            std::string number;
            append_number(number, c.normal + 1);
            result_.bytes.append(number, 1);
        }
        result_.bytes += '\n';
    }

    TextScanner scan_;
    OpenMeshInput result_;
    std::uint64_t normals_ = 0;
    std::vector<ObjCorner> corners_;
    std::vector<std::uint32_t> order_;
};

}  // namespace

OpenMeshInput reduce_obj(const std::string& file, std::string_view bytes) {
    if (bytes.find("\\\n") == std::string_view::npos && bytes.find("\\\r\n") == std::string_view::npos)
        return ObjReducer(file, bytes).reduce();
    // A line that ends in a backslash goes on in the next one. (Line numbers in errors then lag behind.)
    std::string joined(bytes);
    for (std::size_t at = 0; (at = joined.find('\\', at)) != std::string::npos; ++at) {
        std::size_t end = at + 1;
        if (end < joined.size() && joined[end] == '\r') ++end;
        if (end < joined.size() && joined[end] == '\n')
            std::fill(joined.begin() + static_cast<std::ptrdiff_t>(at),
                      joined.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
    }
    return ObjReducer(file, joined).reduce();
}

}  // namespace dfield
