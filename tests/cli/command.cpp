#include "tests/cli/command.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/test_data.hpp"

namespace dfield::test {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kTimeoutSeconds = 120;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void redirect(int descriptor, const fs::path& path) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
}

// Whether the process has put its handler for SIGINT in place.
bool handles_interrupts(int process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:")) return std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1;
    return false;
}

}  // namespace

Json Run::json() const {
    INFO("stdout: " << out << "\nstderr: " << err);
    REQUIRE(Json::accept(out));
    return Json::parse(out);
}

Shell::Shell() {
    fs::copy_file(source_file("models/cube_with_hole.obj"), folder() / "cube.obj");
}

std::vector<std::string> Shell::list(const fs::path& below) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder() / below))
        names.push_back(entry.path().filename().string() + (entry.is_directory() ? "/" : ""));
    std::sort(names.begin(), names.end());
    return names;
}

int Shell::start(const Arguments& arguments, const std::string& stdout_file) const {
    std::vector<const char*> argv{DFIELD_COMMAND};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    argv.push_back(nullptr);
    const fs::path out = stdout_file.empty() ? streams_.path() / "out" : fs::path(stdout_file),
                   err = streams_.path() / "err";
    const int process = fork();
    REQUIRE(process >= 0);
    if (process > 0) return process;
    redirect(STDOUT_FILENO, out);
    redirect(STDERR_FILENO, err);
    if (chdir(folder().c_str()) != 0) _exit(127);
    setenv("DFIELD_CACHE", cache().c_str(), 1);
    alarm(kTimeoutSeconds);  // stays in force through exec
    execv(DFIELD_COMMAND, const_cast<char**>(argv.data()));
    _exit(127);
}

Run Shell::finish(int process) const {
    int status = 0;
    REQUIRE(waitpid(process, &status, 0) == process);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            contents(streams_.path() / "out"), contents(streams_.path() / "err")};
}

Run Shell::run(const Arguments& arguments, const std::string& stdout_file) const {
    return finish(start(arguments, stdout_file));
}

Run Shell::interrupt(const Arguments& arguments) const {
    using namespace std::chrono_literals;
    const int process = start(arguments, {});
    for (int i = 0; i < 1000 && !handles_interrupts(process); ++i) std::this_thread::sleep_for(5ms);
    std::this_thread::sleep_for(500ms);  // well into the work
    kill(process, SIGINT);
    return finish(process);
}

void check_mistake(const Shell& shell, const Arguments& arguments, int exit_code, const std::string& said) {
    const auto before = shell.list();
    const Run run = shell.run(arguments);
    std::string line = "dfield";
    for (const std::string& argument : arguments) line += " '" + argument + "'";
    INFO(line << "\nstderr: " << run.err);
    CHECK(run.exit_code == exit_code);
    CHECK(run.out.empty());
    CHECK(contains(run.err, said));
    CHECK(shell.list() == before);
}

Arguments with_small_field(Arguments arguments) {
    const Arguments small{"--subdivision", "4", "--map-size", "8"};
    arguments.insert(arguments.end(), small.begin(), small.end());
    return arguments;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace dfield::test
