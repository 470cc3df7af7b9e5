#include "tools/darkroom/arguments.h"

namespace latent::darkroom {

namespace {

constexpr const char* kHelp = R"(
latent-darkroom serves one page to the browsers of this machine: the picture of
the samples, and what can still be decided about it. What the page shows is
what latent-print prints, pixel for pixel. The address holds a secret: who
knows it can read and write in the folder of recipes. It ends with Ctrl-C.

Examples:
  latent-darkroom night.latent
      the page opens in the browser, or at the address that it prints
  latent-darkroom parts/ --recipes prints/ --memory 4G
      with recipes and prints in a folder of their own
  ssh -L 8080:127.0.0.1:8080 HOST latent-darkroom night.latent --port 8080
      on another machine, with the browser on this one

Exit status: 0 ended by SIGINT or SIGTERM; 1 failed; 2 wrong usage.)";

}  // namespace

void add_arguments(CLI::App& app, EngineOptions& engine, ServerOptions& server) {
    app.footer(kHelp);
    app.add_option("FILE", engine.inputs, "files of one job, their http(s) URLs, or folders of files")->required();
    app.add_flag("--skip-duplicates", engine.skip_duplicates, "accept files that hold the same samples; each sample is used once");
    app.add_option("--recipes", server.folder, "folder where recipes and prints are kept; nothing is written elsewhere")
        ->type_name("FOLDER")
        ->capture_default_str()
        ->check(CLI::ExistingDirectory);
    cli::add_count(app, "--port", server.port, "port to listen at; 0: one that is free", 0, 65535);
}

}  // namespace latent::darkroom
