// Errors at the C boundary: exceptions inside, a status and a per-thread message outside.
#pragma once

#include <string>

#include "dfield/dfield.h"

namespace dfield::runtime {

// Thrown inside the runtime, never across the C ABI.
struct Failure {
    dfield_status status;
    std::string message;
};

// Keeps the message for dfield_error_message() and hands the status back. Does not allocate or throw.
dfield_status fail(dfield_status status, const char* message) noexcept;

// The status for the exception in flight; call from a catch (...) block only.
dfield_status fail_from_exception() noexcept;

// Runs `body` and turns whatever it throws into a status.
template<class Body>
dfield_status guarded(Body&& body) noexcept {
    try {
        body();
        return DFIELD_OK;
    } catch (...) {
        return fail_from_exception();
    }
}

inline void require(bool condition, const char* message) {
    if (!condition) throw Failure{DFIELD_INVALID_ARGUMENT, message};
}

}  // namespace dfield::runtime
