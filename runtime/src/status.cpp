#include "status.hpp"

#include <cstring>
#include <new>

#include "format/file.hpp"
#include "format/layout.hpp"

namespace dfield::runtime {
namespace {

constexpr std::size_t kMessageSize = 1024;
thread_local char message_of_thread[kMessageSize] = "no error";

}  // namespace

dfield_status fail(dfield_status status, const char* message) noexcept {
    std::strncpy(message_of_thread, message, kMessageSize - 1);
    message_of_thread[kMessageSize - 1] = '\0';
    return status;
}

dfield_status fail_from_exception() noexcept {
    try {
        throw;
    } catch (const Failure& failure) {
        return fail(failure.status, failure.message.c_str());
    } catch (const FormatError& error) {
        return fail(error.code() == FormatErrorCode::kVersion ? DFIELD_VERSION_ERROR : DFIELD_FORMAT_ERROR,
                    error.what());
    } catch (const std::bad_alloc&) {
        return fail(DFIELD_OUT_OF_MEMORY, "out of memory");
    } catch (const std::exception& error) {
        return fail(DFIELD_INTERNAL_ERROR, error.what());
    } catch (...) {
        return fail(DFIELD_INTERNAL_ERROR, "unknown exception");
    }
}

}  // namespace dfield::runtime

extern "C" {

const char* dfield_error_message(void) {
    return dfield::runtime::message_of_thread;
}

const char* dfield_status_name(dfield_status status) {
    switch (status) {
        case DFIELD_OK:
            return "ok";
        case DFIELD_INVALID_ARGUMENT:
            return "invalid argument";
        case DFIELD_OUT_OF_MEMORY:
            return "out of memory";
        case DFIELD_FILE_ERROR:
            return "file error";
        case DFIELD_FORMAT_ERROR:
            return "format error";
        case DFIELD_VERSION_ERROR:
            return "version error";
        case DFIELD_INTERNAL_ERROR:
            return "internal error";
    }
    return "unknown status";
}

uint32_t dfield_version(void) {
    return 10000 * DFIELD_VERSION_MAJOR + 100 * DFIELD_VERSION_MINOR + DFIELD_VERSION_PATCH;
}
}
