// An 8-bit RGB picture, written as a binary PPM, which needs no library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace example {

struct Colour {
    float r, g, b;  // linear, 0..1
};

class Picture {
  public:
    Picture(int width, int height)
        : width_(width), height_(height), bytes_(3 * std::size_t(width) * height) {}

    void set(int x, int y, const Colour& colour) {
        std::uint8_t* pixel = &bytes_[3 * (std::size_t(y) * width_ + x)];
        pixel[0] = encoded(colour.r), pixel[1] = encoded(colour.g), pixel[2] = encoded(colour.b);
    }
    void write(const std::string& path) const {
        std::ofstream file(path, std::ios::binary);
        file << "P6\n" << width_ << ' ' << height_ << "\n255\n";
        file.write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
        if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
    }

  private:
    static std::uint8_t encoded(float linear) {
        const float value = std::clamp(linear, 0.0f, 1.0f);
        return static_cast<std::uint8_t>(255 * std::pow(value, 1 / 2.2f) + 0.5f);
    }

    int width_, height_;
    std::vector<std::uint8_t> bytes_;
};

}  // namespace example
