// A Markdown page with tables and pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/picture/image.hpp"

namespace dfield::bench {

// The first column is aligned left, the others right.
class Table {
  public:
    explicit Table(std::vector<std::string> columns) : rows_{std::move(columns)} {}

    // One cell a column, none empty; throws std::logic_error otherwise.
    void row(std::vector<std::string> cells);

    std::string markdown() const;

  private:
    std::vector<std::vector<std::string>> rows_;  // the first holds the columns' names
};

// Pictures go into a folder beside the page, named like it: results.md has them in results/.
class Page {
  public:
    explicit Page(std::filesystem::path file) : file_(std::move(file)) {}

    void heading(int level, const std::string& title);
    void paragraph(const std::string& text);  // wrapped for the file's readers
    void preformatted(const std::string& text);
    void table(const Table& table);
    void picture(const std::string& name, const Image& image, const std::string& description);
    // A link to a picture that save_picture() wrote, maybe in an earlier run.
    void link_picture(const std::string& name, const std::string& description);
    void save_picture(const std::string& name, const Image& image) const;

    // Atomic; makes the folder. Throws OutputError.
    void save() const;
    // The page is one chapter: it takes the place of the one with the same heading in the file, whose other
    // chapters stay as they are, or comes last. Otherwise as save().
    void save_chapter() const;

  private:
    void block(const std::string& text);

    std::filesystem::path file_;
    std::string text_;
};

std::string grouped(std::uint64_t value);  // 836352 -> "836,352"
std::string square(std::uint32_t side);    // 32 -> "32 × 32"

}  // namespace dfield::bench
