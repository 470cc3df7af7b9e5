#include <cerrno>
#include <cstring>

#include "base/result.h"

namespace latent {

Error Error::at(std::string_view place) const { return {code, std::string(place) + ": " + message}; }

Error error_from_errno(int errno_value, std::string_view path, std::string_view verb) {
    ErrorCode code = ErrorCode::kIo;
    if (errno_value == ENOSPC || errno_value == EDQUOT || errno_value == EFBIG) code = ErrorCode::kNoSpace;
    if (errno_value == ENOENT || errno_value == ENOTDIR) code = ErrorCode::kNotFound;
    if (errno_value == EEXIST) code = ErrorCode::kExists;
    return {code, std::string(path) + ": " + std::string(verb) + ": " + std::strerror(errno_value)};
}

}  // namespace latent
