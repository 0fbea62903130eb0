// Bytes as a gzip file.
#pragma once

#include <zlib.h>

#include <stdexcept>
#include <string>

namespace dfield::test {

inline std::string gzip(const std::string& bytes, int level = 9) {
    const auto require = [](bool done) {
        if (!done) throw std::runtime_error("zlib failed");
    };
    z_stream stream{};
    require(deflateInit2(&stream, level, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    require(deflate(&stream, Z_FINISH) == Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

}  // namespace dfield::test
