#include "baker/import/text_scan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "baker/error.hpp"

namespace dfield {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string_view without_plus(std::string_view token) {
    if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
    return token;
}

}  // namespace

std::string quoted(std::string_view token) {
    std::string text = "'";
    for (const char c : token.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
    return text + (token.size() > 40 ? "...'" : "'");
}

std::optional<float> parse_float(std::string_view token) {
    token = without_plus(token);
    float value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    if (error == std::errc::invalid_argument) return std::nullopt;
    if (stop != end) {
        const bool windows = *stop == '#' || *stop == '(';  // 1.#QNAN, -1.#IND00, nan(ind)
        return windows ? std::optional(kNotFinite) : std::nullopt;
    }
    if (error == std::errc::result_out_of_range) {
        const double wide =
            std::strtod(std::string(token).c_str(), nullptr);  // too small is 0, too large is not
        return std::abs(wide) < 1 ? 0.0f : kNotFinite;
    }
    return std::isfinite(value) ? value : kNotFinite;
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
    token = without_plus(token);
    std::int64_t value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

void append_number(std::string& text, float value) {
    char digits[32];
    text += ' ';
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void append_number(std::string& text, std::uint32_t value) {
    char digits[16];
    text += ' ';
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return lower(x) == lower(y); });
}

void TextScanner::skip_blanks(bool over_lines) {
    while (position_ < text_.size()) {
        const char c = text_[position_];
        if (comment_ != 0 && c == comment_) {
            position_ = std::min(text_.find('\n', position_), text_.size());
        } else if (c == '\n' && over_lines) {
            ++line_;
            ++position_;
        } else if (is_blank(c)) {
            ++position_;
        } else {
            return;
        }
    }
}

std::string_view TextScanner::token_on_line() {
    skip_blanks(false);
    const std::size_t begin = position_;
    while (position_ < text_.size() && text_[position_] != '\n' && !is_blank(text_[position_]) &&
           (comment_ == 0 || text_[position_] != comment_))
        ++position_;
    return text_.substr(begin, position_ - begin);
}

std::string_view TextScanner::token(std::string_view expected) {
    skip_blanks(true);
    const std::string_view found = token_on_line();
    if (found.empty())
        fail("the file ends where " + std::string(expected) +
             " should be: it is cut off or its counts are wrong");
    return found;
}

void TextScanner::skip_line() {
    position_ = std::min(text_.find('\n', position_), text_.size());
    if (position_ < text_.size()) {
        ++position_;
        ++line_;
    }
}

bool TextScanner::at_end() {
    skip_blanks(true);
    return position_ == text_.size();
}

float TextScanner::number(std::string_view expected) {
    const std::string_view found = token(expected);
    const std::optional<float> value = parse_float(found);
    if (!value) fail("expected " + std::string(expected) + ", found " + quoted(found));
    return *value;
}

std::int64_t TextScanner::integer(std::string_view expected) {
    const std::string_view found = token(expected);
    const std::optional<std::int64_t> value = parse_integer(found);
    if (!value) fail("expected " + std::string(expected) + ", found " + quoted(found));
    return *value;
}

std::uint64_t TextScanner::count(std::string_view expected) {
    const std::int64_t value = integer(expected);
    if (value < 0 || value > 0xffffffff) fail(std::string(expected) + " cannot be " + std::to_string(value));
    return static_cast<std::uint64_t>(value);
}

void TextScanner::fail(const std::string& message) const {
    throw InputError(file_ + ": line " + std::to_string(line_) + ": " + message);
}

}  // namespace dfield
