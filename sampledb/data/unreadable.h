// sampledb/data/unreadable.h: bytes that cannot be read as what they should be, as errors.
#pragma once

#include <string>
#include <utility>

#include "base/result.h"

namespace latent::sampledb {

inline Error corrupt(std::string what) { return {ErrorCode::kCorrupt, std::move(what)}; }

// Whether an error is about the bytes of a file being damaged.
inline bool is_damage(const Error& error) { return error.code == ErrorCode::kCorrupt || error.code == ErrorCode::kTruncated; }

// Whether an error is about the bytes that were read, not about reading them: they are damaged, or of a later version. It costs the
// page, the run or the file that they are of, and no more.
inline bool is_unreadable(const Error& error) { return is_damage(error) || error.code == ErrorCode::kUnsupported; }

}  // namespace latent::sampledb
