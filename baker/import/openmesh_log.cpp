#include "baker/import/openmesh_log.hpp"

#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>

namespace dfield {
namespace {

std::mutex openmesh_mutex;

}  // namespace

// The streams' own connect() and disconnect() leak, and forget what was connected; exchanging buffers does
// neither.
OpenMeshLog::OpenMeshLog()
    : lock_(openmesh_mutex),
      log_(omlog().rdbuf(nullptr)),
      out_(omout().rdbuf(nullptr)),
      error_(omerr().rdbuf(said_.rdbuf())) {}

OpenMeshLog::~OpenMeshLog() {
    omlog().rdbuf(log_);
    omout().rdbuf(out_);
    omerr().rdbuf(error_);
}

std::vector<std::string> OpenMeshLog::lines() const {
    constexpr std::size_t kMaxLines = 20;
    std::vector<std::string> lines;
    std::istringstream text(said_.str());
    for (std::string line; lines.size() < kMaxLines && std::getline(text, line);)
        if (!line.empty() && std::find(lines.begin(), lines.end(), line) == lines.end())
            lines.push_back(line);
    return lines;
}

}  // namespace dfield
