// render/program/command_line.h: the arguments of latent-render, and its --help.
#pragma once

#include <optional>

#include "base/cli.h"
#include "render/program/job.h"
#include "render/program/loop.h"

namespace latent::render {

struct CommandLine {
    RenderSettings settings;
    RenderOptions options;
    bool has_output = false;  // the command line names one
    bool dry_run = false, ignore_space = false;
    double preview_seconds = 0;  // 0: none
    bool keep_noise = false;     // in the preview
    std::optional<NoiseTarget> until;
};

// Everything but what all tools take, and what stands below the options.
void add_arguments(CLI::App& app, CommandLine& line);

}  // namespace latent::render
