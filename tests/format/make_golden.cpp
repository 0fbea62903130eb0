// Writes the golden files of the current version: make_golden tests/golden. Run by hand, once a version;
// existing files are left alone.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "format/file.hpp"
#include "format/writer.hpp"
#include "tests/format/golden_fields.hpp"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: make_golden FOLDER\n");
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    for (const auto& [name, field] : dfield::test::golden_fields()) {
        if (std::filesystem::exists(folder / name)) continue;
        const auto bytes = dfield::write_field(field);
        std::ofstream(folder / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        std::ofstream(folder / "payload_hashes.txt", std::ios::app)
            << name << ' ' << dfield::payload_hash(field) << '\n';
        std::printf("%s: %zu bytes\n", name.c_str(), bytes.size());
    }
}
