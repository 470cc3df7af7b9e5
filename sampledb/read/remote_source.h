// sampledb/read/remote_source.h: files on web servers, named by their URLs.
#pragma once

#include <filesystem>
#include <memory>

#include "base/result.h"
#include "sampledb/read/byte_source.h"

namespace latent::sampledb {

// By a module that is loaded when it is needed. Errors: kUnsupported (it is not installed), kNotFound, kIo (sampledb/http).
Result<std::shared_ptr<const ByteSource>> open_remote(const std::filesystem::path& url);

}  // namespace latent::sampledb
