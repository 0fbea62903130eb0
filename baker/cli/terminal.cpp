#include "baker/cli/terminal.hpp"

#include <csignal>
#include <cstdio>

#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

namespace dfield::cli {

std::atomic<bool> interrupted{false};

namespace {

void on_interrupt(int signal) {
    // A second Ctrl-C ends at once, as people expect.
    interrupted = true;
    std::signal(signal, SIG_DFL);
}

bool stderr_is_terminal() {
#if defined(_WIN32)
    return _isatty(_fileno(stderr)) != 0;
#else
    return isatty(STDERR_FILENO) != 0;
#endif
}

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr auto kPlainLine = std::chrono::seconds(5);

}  // namespace

void install_interrupt_handler() {
    std::signal(SIGINT, on_interrupt);
}

ProgressBar::ProgressBar(std::string label, std::string unit, bool quiet)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      quiet_(quiet),
      terminal_(stderr_is_terminal()),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

ProgressBar::~ProgressBar() {
    if (drawn_ && terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(std::uint64_t done, std::uint64_t total) {
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || total == 0 || now - last_ < (terminal_ ? kRedraw : kPlainLine)) return;
    last_ = now;
    drawn_ = true;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double fraction = static_cast<double>(done) / static_cast<double>(total);
    const double left = fraction > 0 ? seconds * (1 - fraction) / fraction : 0;
    const std::string rate = with_prefix(static_cast<double>(done) / seconds) + unit_ + "/s";
    if (terminal_) {
        constexpr int kWidth = 28;
        std::string bar(kWidth, ' ');
        bar.replace(0, static_cast<std::size_t>(fraction * kWidth),
                    static_cast<std::size_t>(fraction * kWidth), '=');
        std::fprintf(stderr, "\r\033[K%s [%s] %3.0f%%  %s  %.0f s left", label_.c_str(), bar.c_str(),
                     100 * fraction, rate.c_str(), left);
    } else {
        std::fprintf(stderr, "%s: %.0f%%, %s, %.0f s left\n", label_.c_str(), 100 * fraction, rate.c_str(),
                     left);
    }
    std::fflush(stderr);
}

std::string with_prefix(double value) {
    const char* prefix = "";
    if (value >= 1e9)
        value /= 1e9, prefix = "G";
    else if (value >= 1e6)
        value /= 1e6, prefix = "M";
    else if (value >= 1e3)
        value /= 1e3, prefix = "k";
    char text[32];
    std::snprintf(text, sizeof text, *prefix ? "%.2f %s" : "%.0f %s", value, prefix);
    return text;
}

std::string bytes_text(std::uint64_t bytes) {
    char text[32];
    if (bytes < 1024)
        std::snprintf(text, sizeof text, "%llu B", static_cast<unsigned long long>(bytes));
    else if (bytes < 1024 * 1024)
        std::snprintf(text, sizeof text, "%.1f KiB", static_cast<double>(bytes) / 1024);
    else
        std::snprintf(text, sizeof text, "%.2f MiB", static_cast<double>(bytes) / (1024 * 1024));
    return text;
}

}  // namespace dfield::cli
