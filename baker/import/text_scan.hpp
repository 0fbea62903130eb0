// Bounded scanning of text formats: tokens, lines, numbers without a locale, errors with a line number.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace dfield {

// What a token such as "nan", "-inf", "1.#QNAN" or "1e99" is read as: OpenMesh's readers cannot say it, and
// usable_position() refuses it. NaN itself would upset the readers that sort positions.
constexpr float kNotFinite = 3.4e38f;

// A finite float; kNotFinite (with its sign lost) for what is not finite; nothing when the token is no
// number.
std::optional<float> parse_float(std::string_view token);

// A decimal integer with optional sign; nothing when it is none or does not fit.
std::optional<std::int64_t> parse_integer(std::string_view token);

// Shortest text that reads back as the same float, with a blank before it.
void append_number(std::string& text, float value);
void append_number(std::string& text, std::uint32_t value);

// A token for a message: in quotes, short, printable.
std::string quoted(std::string_view token);

bool equal_ignoring_case(std::string_view a, std::string_view b);

// Walks over text, token by token; `comment` starts a comment that runs to the end of its line (0: none).
// The text must outlive the scanner.
class TextScanner {
  public:
    TextScanner(std::string file, std::string_view text, char comment)
        : file_(std::move(file)), text_(text), comment_(comment) {}

    // The next token on this or a later line; throws InputError at the end of the text, saying what was
    // `expected`.
    std::string_view token(std::string_view expected);
    // The next token on the current line only; empty at its end.
    std::string_view token_on_line();
    void skip_line();  // to the start of the next line
    bool at_end();     // nothing but blanks and comments is left

    float number(std::string_view expected);          // parse_float() of token(), or InputError
    std::int64_t integer(std::string_view expected);  // parse_integer() of token(), or InputError
    std::uint64_t count(std::string_view expected);   // the same, 0 .. 2^32 - 1

    std::size_t bytes_left() const { return text_.size() - position_; }
    std::string_view rest() const { return text_.substr(position_); }
    // "cow.obj: line 7: " + message
    [[noreturn]] void fail(const std::string& message) const;

  private:
    void skip_blanks(bool over_lines);

    std::string file_;
    std::string_view text_;
    std::size_t position_ = 0;
    std::uint64_t line_ = 1;
    char comment_;
};

}  // namespace dfield
