// tools/darkroom/arguments.h: the arguments of latent-darkroom, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/darkroom/engine/engine.h"
#include "tools/darkroom/server/server.h"

namespace latent::darkroom {

// Everything but what all tools take.
void add_arguments(CLI::App& app, EngineOptions& engine, ServerOptions& server);

}  // namespace latent::darkroom
