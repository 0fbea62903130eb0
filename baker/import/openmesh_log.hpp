// OpenMesh prints to streams of its own and reads files with process-wide readers that keep state. While one
// of these objects lives, nobody else in the process uses either, and what OpenMesh says is collected instead
// of printed.
#pragma once

#include <mutex>
#include <sstream>
#include <string>
#include <vector>

namespace dfield {

class OpenMeshLog {
  public:
    OpenMeshLog();
    ~OpenMeshLog();
    OpenMeshLog(const OpenMeshLog&) = delete;
    OpenMeshLog& operator=(const OpenMeshLog&) = delete;

    // Distinct non-empty lines said so far, at most 20.
    std::vector<std::string> lines() const;

  private:
    std::unique_lock<std::mutex> lock_;
    std::ostringstream said_;
    std::streambuf *log_, *out_, *error_;  // OpenMesh's own, put back by the destructor
};

}  // namespace dfield
