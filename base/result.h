// base/result.h: how the world's faults (files, disks, scenes, arguments) travel. Our own faults are `assert`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace latent {

enum class ErrorCode : std::uint8_t {
    kIo,           // the system refused: errno is in the message
    kNoSpace,      // disk full or quota reached
    kNotFound,     // no such file
    kExists,       // an output that is there already
    kForeign,      // not a file of the kind that was expected
    kTruncated,    // ends before it should
    kCorrupt,      // a checksum, a range or a structure is wrong
    kUnsupported,  // well formed, but not something that this version reads
    kMismatch,     // belongs to another job, another film, another range
    kUsage,        // the arguments contradict each other or the input
    kOutOfRange,   // a value outside the documented range
    kStopped,      // a signal or --max-time; what was committed stays
    kNoMemory,
};

// One line for the user: what, where, and what to do. `at` adds a place in front: "night_03.latent: run 31: checksum mismatch".
struct Error {
    ErrorCode code = ErrorCode::kIo;
    std::string message;

    Error at(std::string_view place) const;
};

// An error in the arguments: programs exit with status 2.
inline Error usage_error(std::string message) { return {ErrorCode::kUsage, std::move(message)}; }

// In a `catch (...)`: the exception in hand, as where threads end. Out of memory it allocates nothing.
Error current_error();

// Error from errno: "PATH: VERB: No space left on device"; code kNoSpace, kNotFound, kExists or kIo.
Error error_from_errno(int errno_value, std::string_view path, std::string_view verb);

template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
 public:
    using tl::expected<T, Error>::expected;
    Result(Error error) : tl::expected<T, Error>(tl::unexpect, std::move(error)) {}  // NOLINT: `return Error{...}` reads well
};

using Status = Result<void>;

// What `call`, a function that returns a Status, returns, or the exception that it throws.
template <class Call>
Status caught(const Call& call) {
    try {
        return call();
    } catch (...) {
        return current_error();
    }
}

}  // namespace latent
