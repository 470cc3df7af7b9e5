// base/hidden_name.h: names of outputs that are not finished yet, and how those of the living are told from what the dead left.
#pragma once

#include <filesystem>

namespace latent {

// An output is made under a hidden name beside its own, ".NAME.<16 hexadecimal digits>.tmp"; a hash stands for NAME if that would
// be too long. Its process holds a lock (flock) on it, which ends with the process, however that ends: what can be locked is
// abandoned. On file systems without locks nothing can.
std::filesystem::path hidden_name(const std::filesystem::path& path);

// Locks what the open descriptor is, until that is closed. False if another process holds the lock; true on file systems without.
// What has a name already when it is locked may have been taken for abandoned before: then it is no longer named, make another.
bool lock_hidden(int fd);

// Whether `path` itself names what the open descriptor is.
bool is_named(int fd, const std::filesystem::path& path);

// Removes files and folders with hidden names of `path` that are abandoned.
void remove_abandoned(const std::filesystem::path& path);

}  // namespace latent
