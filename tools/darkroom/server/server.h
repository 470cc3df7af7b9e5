// tools/darkroom/server/server.h: the darkroom over HTTP, for this machine alone. docs/darkroom_api.md.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "tools/darkroom/engine/engine.h"

namespace latent::darkroom {

struct ServerOptions {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path folder = ".";  // where recipes and prints are
    int port = 0;                        // 0: any that is free
    std::vector<std::string> print;      // latent-print, and what goes before --recipe
};

// latent-print, which lies beside this program, with the inputs of `options` and half of its memory: the views hold the other.
std::vector<std::string> print_command(const EngineOptions& options);

class Server {
 public:
    // Errors: kIo, the port is taken.
    static Result<std::unique_ptr<Server>> open(Engine& engine, const ServerOptions& options);
    virtual ~Server() = default;

    // http://127.0.0.1:PORT/TOKEN/
    virtual std::string address() const = 0;
    virtual int port() const = 0;
    virtual void run() = 0;   // until `stop`
    virtual void stop() = 0;  // from another thread
};

}  // namespace latent::darkroom
