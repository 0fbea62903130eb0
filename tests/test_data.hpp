// Where tests find their data, and how a test says that it cannot run.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace dfield::test {

inline bool skipped = false;

// Says that (a part of) a test did not run, and why. CTest shows the executable as skipped unless something
// in it failed.
inline void skip(const std::string& why) {
    skipped = true;
    std::printf("DFIELD TEST SKIPPED: %s\n", why.c_str());
    std::fflush(stdout);
}

// A file of the source tree, such as "tests/golden/cube.dfield".
inline std::filesystem::path source_file(const std::string& name) {
    return std::filesystem::path(DFIELD_SOURCE_DIR) / name;
}

// A file of the models and scenes that are not part of the repository, such as "models/stanford-bunny.obj":
// in the folder that the environment variable DFIELD_SHARED names, by default `shared` beside the source
// tree. Skips and returns nothing where it is missing.
inline std::optional<std::filesystem::path> shared_file(const std::string& name) {
    const char* folder = std::getenv("DFIELD_SHARED");
    const std::filesystem::path path =
        (folder != nullptr && *folder != '\0' ? std::filesystem::path(folder)
                                              : std::filesystem::path(DFIELD_SOURCE_DIR) / ".." / "shared") /
        name;
    if (std::filesystem::exists(path)) return path;
    skip("no " + path.lexically_normal().string() +
         " (set DFIELD_SHARED to the folder with models/ and scenes/)");
    return std::nullopt;
}

}  // namespace dfield::test
