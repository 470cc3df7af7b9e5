#include "tools/darkroom/server/spawn.h"

#include <unistd.h>

#include <csignal>

namespace latent::darkroom {

Result<pid_t> spawn(const std::vector<std::string>& command, const SpawnFiles& files) {
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, arguments[0], &files.actions(), &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    if (failed != 0) return Error{ErrorCode::kIo, command.front() + ": cannot be started"};
    return child;
}

}  // namespace latent::darkroom
