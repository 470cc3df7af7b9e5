#include "c_api/abi.h"

#include <string>

#include "c_api/words.h"

namespace latent::c {

namespace {

// No `default`: a code without a number of its own would be a warning.
latent_status number_of(ErrorCode code) {
    switch (code) {
        case ErrorCode::kIo:
            return LATENT_IO;
        case ErrorCode::kNoSpace:
            return LATENT_NO_SPACE;
        case ErrorCode::kNotFound:
            return LATENT_NOT_FOUND;
        case ErrorCode::kExists:
            return LATENT_EXISTS;
        case ErrorCode::kForeign:
            return LATENT_FOREIGN;
        case ErrorCode::kTruncated:
            return LATENT_TRUNCATED;
        case ErrorCode::kCorrupt:
            return LATENT_CORRUPT;
        case ErrorCode::kUnsupported:
            return LATENT_UNSUPPORTED;
        case ErrorCode::kMismatch:
            return LATENT_MISMATCH;
        case ErrorCode::kUsage:
            return LATENT_USAGE;
        case ErrorCode::kOutOfRange:
            return LATENT_OUT_OF_RANGE;
        case ErrorCode::kStopped:
            return LATENT_STOPPED;
        case ErrorCode::kNoMemory:
            return LATENT_NO_MEMORY;
    }
    return LATENT_IO;
}

constexpr Word kFields[] = {{"--job", "options.job_low and job_high"},
                            {"--skip-duplicates", "options.skip_duplicates"},
                            {"--force", "options.replace"},
                            {"--memory", "options.memory"},
                            {"--compact", "options.compact"}};

// As much of a message as has room. Out of memory, the words stay as they are.
void copy_message(const std::string& message, latent_error& error) noexcept {
    const auto copy = [&](const std::string& text) {
        std::size_t size = std::min(text.size(), sizeof(error.message) - 1);
        while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0) == 0x80) --size;  // whole characters
        std::memcpy(error.message, text.data(), size);
        error.message[size] = 0;
    };
    try {
        copy(reworded(message, kFields));
    } catch (...) {
        copy(message);
    }
}

}  // namespace

latent_status report(const Status& status, latent_error* error) noexcept {
    const latent_status number = status ? LATENT_OK : number_of(status.error().code);
    if (error == nullptr) return number;
    error->status = number;
    error->message[0] = 0;
    if (!status) copy_message(status.error().message, *error);
    return number;
}

}  // namespace latent::c

const char* latent_version(void) { return LATENT_VERSION; }
