// Runs the dfield command as a user would: as a process of its own, in a fresh folder, with a fresh cache.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/import/test_files.hpp"

namespace dfield::test {

using Json = nlohmann::ordered_json;
using Arguments = std::vector<std::string>;

struct Run {
    int exit_code = -1;  // 128 + the signal's number where one ended the process, as shells count
    std::string out, err;

    Json json() const;  // stdout, which must be one JSON document and nothing else
};

class Shell {
  public:
    // The command's current folder. Holds cube.obj, a copy of models/cube_with_hole.obj, and nothing else.
    const std::filesystem::path& folder() const { return folder_.path(); }
    const std::filesystem::path& cache() const { return cache_.path(); }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        return folder_.write(name, bytes);
    }
    // Names of the files in a folder below the current one, sorted, with a slash after folders.
    std::vector<std::string> list(const std::filesystem::path& below = {}) const;

    Shell();
    // `stdout_file`: where stdout goes instead of into Run::out.
    Run run(const Arguments& arguments, const std::string& stdout_file = {}) const;
    // The same, pressing Ctrl-C a moment after the command has begun.
    Run interrupt(const Arguments& arguments) const;

  private:
    Run finish(int process) const;
    int start(const Arguments& arguments, const std::string& stdout_file) const;

    TestFolder folder_, cache_, streams_;
};

// A mistake gives its exit code and, on stderr alone, a message with `said` in it, and leaves no file behind.
void check_mistake(const Shell& shell, const Arguments& arguments, int exit_code, const std::string& said);

// A field that bakes in a millisecond; appended to the arguments.
Arguments with_small_field(Arguments arguments);

bool contains(const std::string& text, const std::string& part);

}  // namespace dfield::test
