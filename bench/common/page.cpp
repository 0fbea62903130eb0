#include "bench/common/page.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "baker/file_io.hpp"
#include "baker/picture/font.hpp"

namespace dfield::bench {
namespace {

constexpr std::size_t kColumns = 118;

std::string line_of(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + "\n";
}

}  // namespace

void Table::row(std::vector<std::string> cells) {
    if (cells.size() != rows_.front().size() ||
        std::any_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); }))
        throw std::logic_error("a row of the table \"" + rows_.front().front() +
                               "\" has missing or empty cells");
    rows_.push_back(std::move(cells));
}

std::string Table::markdown() const {
    std::string result = line_of(rows_.front()) + "|---|";
    for (std::size_t i = 1; i < rows_.front().size(); ++i) result += "---:|";
    result += "\n";
    for (auto row = rows_.begin() + 1; row != rows_.end(); ++row) result += line_of(*row);
    return result;
}

void Page::block(const std::string& text) {
    if (!text_.empty()) text_ += "\n";
    text_ += text;
}

void Page::heading(int level, const std::string& title) {
    block(std::string(static_cast<std::size_t>(level), '#') + " " + title + "\n");
}

void Page::paragraph(const std::string& text) {
    std::string wrapped;
    for (const std::string& line : wrap_text(text, kColumns)) wrapped += line + "\n";
    block(wrapped);
}

void Page::preformatted(const std::string& text) {
    block("    " + text + "\n");
}

void Page::table(const Table& table) {
    block(table.markdown());
}

void Page::picture(const std::string& name, const Image& image, const std::string& description) {
    save_picture(name, image);
    link_picture(name, description);
}

void Page::save_picture(const std::string& name, const Image& image) const {
    const std::filesystem::path folder = file_.parent_path() / file_.stem();
    std::filesystem::create_directories(folder);
    write_png(folder / (name + ".png"), image);
}

void Page::link_picture(const std::string& name, const std::string& description) {
    block("![" + description + "](" + file_.stem().string() + "/" + name + ".png)\n");
}

void Page::save() const {
    if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path());
    write_file_atomic(file_, text_);
}

void Page::save_chapter() const {
    const std::string heading = text_.substr(0, text_.find('\n') + 1);
    const std::string marks = heading.substr(0, heading.find(' ') + 1);  // "## "
    Page whole(file_);
    bool found = false, skipped = false;
    std::string before, after;
    std::ifstream file(file_);
    for (std::string line; std::getline(file, line);) {
        line += '\n';
        if (line.starts_with(marks)) {
            skipped = line == heading;
            found = found || skipped;
        }
        if (!skipped) (found ? after : before) += line;
    }
    while (before.ends_with("\n\n")) before.pop_back();
    for (const std::string& part : {before, text_, after})
        if (!part.empty()) whole.block(part);
    whole.save();
}

std::string grouped(std::uint64_t value) {
    const std::string digits = std::to_string(value);
    std::string result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) result += ',';
        result += digits[i];
    }
    return result;
}

std::string square(std::uint32_t side) {
    return std::to_string(side) + " × " + std::to_string(side);
}

}  // namespace dfield::bench
