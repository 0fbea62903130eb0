#include "baker/hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace dfield {

struct ContentHash::State {
    XXH3_state_t xxh;
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
    XXH3_128bits_reset(&state_->xxh);
}
ContentHash::~ContentHash() = default;

ContentHash& ContentHash::add(const void* data, std::size_t size) {
    XXH3_128bits_update(&state_->xxh, data, size);
    return *this;
}

std::string ContentHash::hex() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&state_->xxh));
    std::string text;
    for (const unsigned char byte : canonical.digest) {
        text += "0123456789abcdef"[byte >> 4];
        text += "0123456789abcdef"[byte & 15];
    }
    return text;
}

std::string hash_hex(std::string_view text) {
    return ContentHash().add(text.data(), text.size()).hex();
}

}  // namespace dfield
