// The baker's one exception: a message for the user and the exit code that the CLI answers with.
#pragma once

#include <stdexcept>
#include <string>

namespace dfield {

// Exit codes of the command line; documented in `dfield --help` and README.
enum class ExitCode : int {
    kOk = 0,
    kInternal = 1,      // our bug, or out of memory
    kUsage = 2,         // unknown flag, bad value
    kInput = 3,         // a model, scene or field that cannot be read
    kOutput = 4,        // an output that cannot be written
    kPartial = 5,       // some models of a batch failed; the others are done
    kInvalid = 6,       // `validate` found errors
    kInterrupted = 130  // Ctrl-C
};

class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

// Bad or unreadable input: "cow.obj: line 7: ...; do ...".
struct InputError : Error {
    explicit InputError(const std::string& message) : Error(ExitCode::kInput, message) {}
};

// An output that could not be written.
struct OutputError : Error {
    explicit OutputError(const std::string& message) : Error(ExitCode::kOutput, message) {}
};

}  // namespace dfield
