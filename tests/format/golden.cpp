// Files of released versions are read for ever.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "format/file.hpp"
#include "format/writer.hpp"
#include "tests/format/file_editor.hpp"
#include "tests/format/golden_fields.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

Bytes file_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    REQUIRE(stream);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    Bytes bytes(text.size());
    std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
    return bytes;
}

// "name hash" lines of tests/golden/payload_hashes.txt.
std::map<std::string, std::string> pinned_hashes() {
    std::ifstream stream(source_file("tests/golden/payload_hashes.txt"));
    REQUIRE(stream);
    std::map<std::string, std::string> hashes;
    for (std::string name, hash; stream >> name >> hash;) hashes[name] = hash;
    return hashes;
}

}  // namespace

TEST_CASE("golden files decode to what they always were") {
    const auto hashes = pinned_hashes();
    REQUIRE(hashes.size() >= 10);
    for (const auto& [name, hash] : hashes) {
        INFO(name);
        const Bytes bytes = file_bytes(source_file("tests/golden/" + name));
        REQUIRE(accepted(bytes));
        CHECK(payload_hash(read_field(bytes)) == hash);
    }
    for (const auto& entry : std::filesystem::directory_iterator(source_file("tests/golden")))
        if (entry.path().extension() == ".dfield") CHECK(hashes.count(entry.path().filename().string()) == 1);
}

TEST_CASE("golden fields are written as they were") {
    const auto hashes = pinned_hashes();
    for (const auto& [name, field] : golden_fields()) {
        INFO(name);
        CHECK(payload_hash(field) == hashes.at(name));
        const Bytes golden = file_bytes(source_file("tests/golden/" + name));
        CHECK(same_kinds(read_field(golden), field));
        // zstd's frames may differ between its versions, what is in them may not.
        const FileEditor ours(write_field(field)), theirs(golden);
        REQUIRE(ours.sections.size() == theirs.sections.size());
        for (std::size_t i = 0; i < ours.sections.size(); ++i) {
            CHECK(ours.sections[i].id == theirs.sections[i].id);
            CHECK(ours.sections[i].raw == theirs.sections[i].raw);
        }
    }
}
