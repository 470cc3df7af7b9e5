// base/temporary_path.h: files and folders that stay neither when their owner is done nor when a signal ends the program.
#pragma once

#include <filesystem>
#include <mutex>

namespace latent {

// The name of a file or folder, reserved before it is made. Both are removed, with all that is in them, by the destructor.
class TemporaryPath {
 public:
    TemporaryPath() = default;
    explicit TemporaryPath(std::filesystem::path path);
    TemporaryPath(TemporaryPath&& other) noexcept;
    TemporaryPath& operator=(TemporaryPath&& other) noexcept;
    TemporaryPath(const TemporaryPath&) = delete;
    TemporaryPath& operator=(const TemporaryPath&) = delete;
    ~TemporaryPath();

    bool empty() const { return path_.empty(); }
    const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

// For main, before there are other threads: SIGINT, SIGTERM and SIGHUP, unless they are ignored, first remove all that is
// temporary, then end the program as they would have. Throws std::runtime_error if the system refuses the thread that waits.
void remove_temporaries_on_signals();

// Removes all that is temporary, for a program that is about to end: from here on nothing gets its name any more.
void remove_temporaries();

// While it is held, such signals wait: what gets its name in several steps gets it wholly.
std::unique_lock<std::recursive_mutex> hold_signals();

}  // namespace latent
