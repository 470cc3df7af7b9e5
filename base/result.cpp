#include "base/result.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

namespace latent {

// A message that begins with the place (as those of the system's refusals begin with the file) does not say it twice.
Error Error::at(std::string_view place) const {
    const std::string front = std::string(place) + ": ";
    return {code, message.starts_with(front) ? message : front + message};
}

Error current_error() {
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return {ErrorCode::kNoMemory, "out of memory"};
    } catch (const std::length_error&) {  // more than a vector can have
        return {ErrorCode::kNoMemory, "out of memory"};
    } catch (const std::exception& exception) {
        return {ErrorCode::kIo, exception.what()};
    } catch (...) {
        return {ErrorCode::kIo, "an exception of an unknown kind"};
    }
}

Error error_from_errno(int errno_value, std::string_view path, std::string_view verb) {
    ErrorCode code = ErrorCode::kIo;
    if (errno_value == ENOSPC || errno_value == EDQUOT || errno_value == EFBIG) code = ErrorCode::kNoSpace;
    if (errno_value == ENOENT || errno_value == ENOTDIR) code = ErrorCode::kNotFound;
    if (errno_value == EEXIST) code = ErrorCode::kExists;
    const char* advice = errno_value == EMFILE ? " (raise the limit with ulimit -n)" : "";
    return {code, std::string(path) + ": " + std::string(verb) + ": " + std::strerror(errno_value) + advice};
}

}  // namespace latent
