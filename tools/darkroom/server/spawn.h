// tools/darkroom/server/spawn.h: other programs, started beside this one.
#pragma once

#include <spawn.h>
#include <sys/types.h>

#include <string>
#include <vector>

#include "base/result.h"

namespace latent::darkroom {

// The files that a program is to have beside those of this one.
class SpawnFiles {
 public:
    SpawnFiles() { ::posix_spawn_file_actions_init(&actions_); }
    ~SpawnFiles() { ::posix_spawn_file_actions_destroy(&actions_); }
    SpawnFiles(const SpawnFiles&) = delete;
    SpawnFiles& operator=(const SpawnFiles&) = delete;

    void open(int descriptor, const std::string& path, int flags) {
        ::posix_spawn_file_actions_addopen(&actions_, descriptor, path.c_str(), flags, 0);
    }
    void copy(int from, int descriptor) { ::posix_spawn_file_actions_adddup2(&actions_, from, descriptor); }
    const posix_spawn_file_actions_t& actions() const { return actions_; }

 private:
    posix_spawn_file_actions_t actions_;
};

// Starts a program, found on the PATH, with its arguments. Signals that this thread blocks are not blocked there. Errors: kIo.
Result<pid_t> spawn(const std::vector<std::string>& command, const SpawnFiles& files);

}  // namespace latent::darkroom
