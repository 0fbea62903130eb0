// Content hashes: XXH3-128 as 32 hex digits.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace dfield {

// Hashes data piece by piece.
class ContentHash {
  public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    ContentHash& add(const void* data, std::size_t size);
    std::string hex() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string hash_hex(std::string_view text);

}  // namespace dfield
