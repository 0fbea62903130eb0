// What people see while a command runs: progress on stderr, and Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace dfield::cli {

// Set by the handler that install_interrupt_handler() puts in place; long loops watch it.
extern std::atomic<bool> interrupted;
void install_interrupt_handler();

// A bar with rate and time left on a terminal, a plain line every few seconds elsewhere, nothing when quiet.
class ProgressBar {
  public:
    // unit: what is counted, "ray"; label: what is being done, "bunny.obj".
    ProgressBar(std::string label, std::string unit, bool quiet);
    ~ProgressBar();

    void update(std::uint64_t done, std::uint64_t total);

  private:
    std::string label_, unit_;
    bool quiet_, terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

// 1234567 -> "1.23 M", for people.
std::string with_prefix(double value);
// 12345 -> "12.1 KiB" (K = 1024).
std::string bytes_text(std::uint64_t bytes);

}  // namespace dfield::cli
