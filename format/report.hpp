// Where the reader's findings go: the first error thrown, or all of them collected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "format/file.hpp"
#include "format/layout.hpp"

namespace dfield {

class Report {
  public:
    // Throws FormatError at the first error and ignores warnings.
    Report() = default;
    // Collects.
    explicit Report(std::vector<Finding>& findings) : findings_(&findings) {}

    // `offset` is into the file. Answers false, so that checks can end with `return report.error(...)`.
    bool error(FormatErrorCode code, std::uint64_t offset, const std::string& message) {
        ++error_count_;
        if (findings_ == nullptr)
            throw FormatError(code, message + " (byte " + std::to_string(offset) + ", error " +
                                        std::to_string(static_cast<std::uint32_t>(code)) + ")");
        findings_->push_back({code, Finding::Severity::kError, offset, message});
        return false;
    }
    void warning(FormatErrorCode code, std::uint64_t offset, const std::string& message) {
        if (findings_ != nullptr) findings_->push_back({code, Finding::Severity::kWarning, offset, message});
    }

    std::size_t error_count() const { return error_count_; }

  private:
    std::vector<Finding>* findings_ = nullptr;
    std::size_t error_count_ = 0;
};

}  // namespace dfield
