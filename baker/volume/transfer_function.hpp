// A 1D transfer function: opacity and colour of a voxel's value.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

namespace dfield {

// Piecewise linear in both; constant beyond the first and the last point. Two points at the same value make a
// step, which belongs to the second.
class TransferFunction {
  public:
    struct Opacity {
        double value = 0;
        float opacity = 0;  // 0..1, of a layer one reference length thick; what that is, the user says
    };
    struct Colour {
        double value = 0;
        glm::vec3 rgb{1};  // 0..1
    };

    // Values ascend, all numbers are finite and in range; at least one point. No colours: white. Throws
    // std::invalid_argument, which says what is wrong.
    explicit TransferFunction(std::vector<Opacity> points, std::vector<Colour> colours = {});

    float opacity(double value) const;
    glm::vec3 colour(double value) const;
    const std::vector<Opacity>& points() const { return points_; }
    const std::vector<Colour>& colours() const { return colours_; }

  private:
    std::vector<Opacity> points_;
    std::vector<Colour> colours_;
};

// {"points": [[value, opacity], ...], "colors": [[value, red, green, blue], ...]}, colors optional; or lines
// of text: value and opacity, or value, red, green, blue and opacity, separated by spaces or commas, # for
// comments. Throws InputError that names the file.
TransferFunction read_transfer_function(const std::filesystem::path& path);
// The same from text; `name` stands for the file in messages.
TransferFunction parse_transfer_function(std::string_view text, const std::string& name);

}  // namespace dfield
