// render/program/help.h: the text of `--help` below the options: examples, exit status.
#pragma once

namespace latent::render {

inline constexpr const char* kBelowOptions =
    "Run the same command again to resume an interrupted render. With a larger --spp,\n"
    "it extends a finished one. To use several machines, see latent-farm, or render\n"
    "one shard on each, with the same settings, and join them with latent-merge.\n\n"
    "Examples:\n"
    "  latent-render scenes/cornell.pbrt -o cornell.latent --spp 64\n"
    "      render a scene\n"
    "  latent-render scenes/cornell.pbrt -o half0.latent --spp 64 --shard 0/2\n"
    "  latent-render scenes/cornell.pbrt -o half1.latent --spp 64 --shard 1/2\n"
    "      render the same samples in two processes\n"
    "  latent-render scenes/cornell.pbrt -o big.latent --resolution 16Kx16K --dry-run\n"
    "      estimate time and file size first\n"
    "  latent-render model.glb --add lamps.pbrt -o model.latent --spp 64\n"
    "      render a model under the lamps of a pbrt file\n"
    "  latent-render scenes/cornell.pbrt --preview 5s\n"
    "      preview the picture first, in cornell.preview.png\n\n"
    "Exit status: 0 done; 1 failed; 2 wrong usage; 3 done, but the report could not\n"
    "be written; 75 interrupted, all finished work saved: run again to resume.";

}  // namespace latent::render
