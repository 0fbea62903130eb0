#include "baker/volume/nrrd_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

#include "baker/error.hpp"
#include "baker/import/text_scan.hpp"
#include "baker/volume/data_stream.hpp"

namespace dfield {
namespace {

constexpr std::size_t kMaxHeaderBytes = 1 << 20;
constexpr std::size_t kMaxFieldBytes = 2048;
constexpr std::size_t kMaxDataFiles = 65536;

enum class Values { kText, kIntegers, kNumbers, kUnits, kIgnored, kDataFile };

struct Field {
    std::string_view name;  // in lower case, without blanks
    Values values;
};

constexpr std::array kFields{
    Field{"type", Values::kText},
    Field{"blocksize", Values::kIntegers},
    Field{"dimension", Values::kIntegers},
    Field{"space", Values::kText},
    Field{"spacedimension", Values::kIntegers},
    Field{"sizes", Values::kIntegers},
    Field{"spacings", Values::kNumbers},
    Field{"axismins", Values::kNumbers},
    Field{"axismaxs", Values::kNumbers},
    Field{"spacedirections", Values::kNumbers},
    Field{"spaceorigin", Values::kNumbers},
    Field{"centers", Values::kText},
    Field{"centerings", Values::kText},
    Field{"kinds", Values::kText},
    Field{"units", Values::kUnits},
    Field{"spaceunits", Values::kUnits},
    Field{"endian", Values::kText},
    Field{"encoding", Values::kText},
    Field{"lineskip", Values::kIntegers},
    Field{"byteskip", Values::kIntegers},
    Field{"datafile", Values::kDataFile},
    // Of no use to scalar volumes.
    Field{"content", Values::kIgnored},
    Field{"number", Values::kIgnored},
    Field{"min", Values::kIgnored},
    Field{"max", Values::kIgnored},
    Field{"oldmin", Values::kIgnored},
    Field{"oldmax", Values::kIgnored},
    Field{"thicknesses", Values::kIgnored},
    Field{"labels", Values::kIgnored},
    Field{"sampleunits", Values::kIgnored},
    Field{"measurementframe", Values::kIgnored},
};

const Field* find_field(std::string_view name) {
    std::string plain;
    for (const char c : name)
        if (c != ' ') plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const auto field =
        std::find_if(kFields.begin(), kFields.end(), [&](const Field& f) { return f.name == plain; });
    return field == kFields.end() ? nullptr : &*field;
}

std::vector<std::string_view> tokens_of(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> tokens;
    for (std::size_t begin = 0; (begin = text.find_first_not_of(separators, begin)) != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        tokens.push_back(text.substr(begin, end - begin));
        begin = end;
    }
    return tokens;
}

bool is_number(std::string_view token) {
    if (token == "none" || equal_ignoring_case(token, "nan")) return true;  // an axis without the property
    if (token.starts_with('+')) token.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    return error == std::errc() && end == token.data() + token.size();
}

// Walks over the header, line by line.
class HeaderReader {
  public:
    explicit HeaderReader(const std::filesystem::path& path) : path_(path) {
        DataStream file(path, DataStream::Encoding::kRaw);
        text_.resize(std::min<std::uint64_t>(file.most_bytes(), kMaxHeaderBytes));
        text_.resize(file.read(std::as_writable_bytes(std::span(text_))));
        cut_ = file.most_bytes() > kMaxHeaderBytes;
    }

    NrrdHeader read() {
        const std::string magic = line();
        if (!magic.starts_with("NRRD00"))
            throw InputError(
                path_.string() +
                ": is no NRRD file: it does not begin with NRRD and a version, such as NRRD0004");
        header_.fields = magic + '\n';
        while (!at_end()) {
            const std::string text = line();
            if (text.empty()) {
                blank_line_ = true;
                break;
            }
            if (text[0] != '#') field(text);
        }
        // Teem looks for missing fields only in files, not in strings.
        for (const std::string_view required : {"type", "dimension", "sizes", "encoding"})
            if (std::find(seen_.begin(), seen_.end(), required) == seen_.end())
                throw InputError(path_.string() + ": its header has no '" + std::string(required) +
                                 ":' before the blank line or its end; add it");
        if (!header_.detached) {
            if (!blank_line_)
                throw InputError(
                    path_.string() + ": " +
                    (cut_ ? "its header is longer than 1 MiB"
                          : "its header is cut off: no blank line before the voxels, and no 'data "
                            "file:'"));
            header_.data_files = {path_};
            header_.data_offset = position_;
        }
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(path_.string() + ": line " + std::to_string(line_number_) + ": " + message);
    }
    bool at_end() const { return position_ >= text_.size(); }

    std::string line() {
        ++line_number_;
        const std::size_t end = std::min(text_.find('\n', position_), text_.size());
        std::string line = text_.substr(position_, end - position_);
        position_ = std::min(end + 1, text_.size());
        if (line.ends_with('\r')) line.pop_back();
        if (line.size() > 2 * kMaxFieldBytes && line[0] != '#' && line.find(":=") == line.npos)
            fail("is " + std::to_string(line.size()) + " bytes long; this is no NRRD header");
        return line;
    }

    void field(const std::string& text) {
        const std::size_t colon = text.find(": ");
        const Field* known =
            colon == text.npos ? nullptr : find_field(std::string_view(text).substr(0, colon));
        if (known == nullptr) {
            if (text.find(":=") != text.npos) return;  // the user's own keys
            fail(quoted(std::string_view(text)) +
                 " is no field of an NRRD header, which has lines such as 'sizes: 64 64 93'");
        }
        const std::string_view value = std::string_view(text).substr(colon + 2);
        if (known->values == Values::kIgnored) return;
        if (known->values == Values::kDataFile) return data_file(value);
        if (text.size() > kMaxFieldBytes) fail("is too long for '" + text.substr(0, colon) + "'");
        for (const char c : text)
            if ((c < ' ' && c != '\t') || c > '~') fail("has a byte that is no printable ASCII");
        if (known->values == Values::kIntegers) {
            const std::int64_t limit = known->name == "byteskip" ? INT64_MAX : INT32_MAX;
            for (const std::string_view token : tokens_of(value, " \t"))
                if (const auto number = parse_integer(token); !number || *number > limit || *number < -1)
                    fail(quoted(token) + " in '" + text.substr(0, colon) + "' is no whole number in range");
        }
        if (known->values == Values::kNumbers)
            for (const std::string_view token : tokens_of(value, " \t(),"))
                if (!is_number(token))
                    fail(quoted(token) + " in '" + text.substr(0, colon) + "' is no number");
        // Teem asks for the same, but forgets to free what it has begun.
        if ((known->name == "centers" || known->name == "centerings" || known->name == "kinds") &&
            std::find(seen_.begin(), seen_.end(), "dimension") == seen_.end())
            fail("'" + text.substr(0, colon) + "' before 'dimension'");
        seen_.push_back(known->name);
        if (known->values == Values::kUnits)
            units(value);
        else
            header_.fields += text + '\n';
    }

    // A quoted string for each axis. Teem leaks what is not closed.
    void units(std::string_view value) {
        std::string unit;
        bool open = false;
        for (std::size_t i = 0; i < value.size(); ++i) {
            const char c = value[i];
            if (c == '"') {
                if (open && header_.unit.empty()) header_.unit = unit;
                unit.clear();
                open = !open;
            } else if (open) {
                if (c == '\\' && i + 1 < value.size() && value[i + 1] == '"') ++i;
                unit += value[i];
            } else if (c != ' ' && c != '\t') {
                fail("units are in quotes, such as \"mm\" \"mm\" \"mm\"");
            }
        }
        if (open) fail("the quotes of a unit do not end");
    }

    void data_file(std::string_view value) {
        if (header_.detached) fail("a second 'data file'");
        header_.detached = true;
        while (value.starts_with(' ') || value.starts_with('\t')) value.remove_prefix(1);
        const std::vector<std::string_view> tokens = tokens_of(value, " \t");
        if (tokens.empty()) fail("'data file:' names no file");
        if (tokens[0] == "SKIPLIST") fail("dfield does not read SKIPLIST; use LIST");
        if (tokens[0] == "LIST") {
            if (tokens.size() > 1) header_.piece_axes = piece_axes(tokens[1]);
            while (!at_end())
                if (const std::string name = line(); !name.empty()) add_file(name);
            if (header_.data_files.empty()) fail("'data file: LIST' with no file after it");
        } else if (tokens.size() >= 4 && tokens[0].find('%') != std::string_view::npos) {
            numbered_files(tokens);
        } else {
            add_file(std::string(value));
        }
    }

    // <name with %d> <first> <last> <step> [<axes of a piece>]
    void numbered_files(const std::vector<std::string_view>& tokens) {
        const std::string_view pattern = tokens[0];
        const std::size_t percent = pattern.find('%');
        std::size_t end = percent + 1;
        while (end < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[end])) != 0) ++end;
        const std::string_view digits = pattern.substr(percent + 1, end - percent - 1);
        const std::size_t width =
            digits.empty() ? 0 : static_cast<std::size_t>(parse_integer(digits.substr(0, 9)).value_or(0));
        if (end >= pattern.size() || pattern[end] != 'd' || pattern.find('%', end) != pattern.npos ||
            width > 32)
            fail(quoted(pattern) + " is no pattern for numbered files, such as slice%03d.raw");
        std::array<std::int64_t, 3> numbers{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto number = parse_integer(tokens[i + 1]);
            if (!number || *number > INT32_MAX || *number < INT32_MIN)
                fail(quoted(tokens[i + 1]) + " is no file number");
            numbers[i] = *number;
        }
        const auto [first, last, step] = numbers;
        if (step == 0 || (last - first) / step < 0 || (last != first && (last > first) != (step > 0)))
            fail("file numbers do not get from " + std::to_string(first) + " to " + std::to_string(last) +
                 " by steps of " + std::to_string(step));
        if (tokens.size() > 4) header_.piece_axes = piece_axes(tokens[4]);
        const std::int64_t count = (last - first) / step + 1;
        for (std::int64_t i = 0; i < count; ++i) {
            const std::int64_t value = first + i * step;
            std::string number = std::to_string(value < 0 ? -value : value);
            const std::size_t sign = value < 0 ? 1 : 0;
            if (number.size() + sign < width)
                number.insert(0, width - number.size() - sign, digits[0] == '0' ? '0' : ' ');
            add_file(std::string(pattern.substr(0, percent)) + (value < 0 ? "-" : "") + number +
                     std::string(pattern.substr(end + 1)));
        }
    }

    std::size_t piece_axes(std::string_view token) const {
        const auto axes = parse_integer(token);
        if (!axes || *axes < 1 || *axes > 16) fail(quoted(token) + " is no number of axes of a data file");
        return static_cast<std::size_t>(*axes);
    }

    void add_file(const std::string& name) {
        if (header_.data_files.size() >= kMaxDataFiles) fail("more than 65536 data files");
        if (name == "-") fail("the data file is '-'; write the voxels to a file");
        if (name.find('\0') != name.npos) fail("the name of the data file has a zero byte");
        header_.data_files.push_back(path_.parent_path() / name);  // an absolute name stays what it is
    }

    const std::filesystem::path path_;
    std::string text_;
    std::size_t position_ = 0, line_number_ = 0;
    bool cut_ = false, blank_line_ = false;
    std::vector<std::string_view> seen_;  // fields
    NrrdHeader header_;
};

}  // namespace

NrrdHeader read_nrrd_header(const std::filesystem::path& path) {
    return HeaderReader(path).read();
}

}  // namespace dfield
