// Teem's own types freed by themselves, and its one global list of errors read in peace.
#pragma once

#include <teem/nrrd.h>

#include <memory>
#include <mutex>
#include <string>

namespace dfield {

struct TeemDeleter {
    void operator()(Nrrd* nrrd) const { nrrdNix(nrrd); }  // not the voxels, which are never teem's
    void operator()(NrrdIoState* state) const { nrrdIoStateNix(state); }
};
using NrrdPointer = std::unique_ptr<Nrrd, TeemDeleter>;
using NrrdIoPointer = std::unique_ptr<NrrdIoState, TeemDeleter>;

// While one of these lives nobody else in the process uses teem.
class TeemLock {
  public:
    TeemLock();
    ~TeemLock();
    TeemLock(const TeemLock&) = delete;
    TeemLock& operator=(const TeemLock&) = delete;

    // Why the last call failed, without the names of teem's functions: its innermost message.
    std::string error() const;

  private:
    std::unique_lock<std::mutex> lock_;
};

}  // namespace dfield
