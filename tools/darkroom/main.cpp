// latent-darkroom: what can be decided after rendering, on a page.
#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "base/cli.h"
#include "base/json.h"
#include "tools/darkroom/arguments.h"
#include "tools/darkroom/engine/engine.h"
#include "tools/darkroom/server/server.h"
#include "tools/darkroom/server/spawn.h"

namespace {

std::string introduction(const latent::darkroom::Server& server, const std::filesystem::path& folder, bool json) {
    if (json) return latent::json_text(nlohmann::ordered_json{{"address", server.address()}, {"port", server.port()}}) + "\n";
    return fmt::format(
        "{0}\nOpen this address in a browser of this machine. From another one, first: ssh -L {1}:127.0.0.1:{1} THIS-MACHINE\n"
        "Recipes and prints are kept in {2}. Ctrl-C ends.\n",
        server.address(), server.port(), std::filesystem::absolute(folder / "").lexically_normal().string());
}

// Somebody sits before a desktop, and typed the command.
bool has_desktop() {
    return ::isatty(STDOUT_FILENO) == 1 && (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr);
}

// Where there is no xdg-open, the address that is printed will do.
void open_in_browser(const std::string& address) {
    latent::darkroom::SpawnFiles quiet;
    for (const int output : {STDOUT_FILENO, STDERR_FILENO}) quiet.open(output, "/dev/null", O_WRONLY);
    (void)latent::darkroom::spawn({"xdg-open", address}, quiet);
}

}  // namespace

int main(int argc, char** argv) try {
    using namespace latent;

    darkroom::EngineOptions opened;
    darkroom::ServerOptions served;
    cli::CommonOptions common;
    CLI::App app{"See samples as a print, and decide about it, on a page in a browser.", "latent-darkroom"};
    darkroom::add_arguments(app, opened, served);
    std::optional<bool> opens;
    app.add_flag_function(
        "--open,!--no-open", [&opens](std::int64_t given) { opens = given > 0; },
        "open the page in a browser (default: if started in a terminal of a desktop)");
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    // Before there is a thread: all leave these signals to the one that waits for them.
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ends, nullptr);

    opened.memory = common.memory;
    opened.threads = common.threads;
    const auto engine = darkroom::Engine::open(opened);
    if (!engine) return cli::fail(engine.error());
    cli::tell((*engine)->runs()->report().notes, {}, {});
    served.inputs = opened.inputs;
    served.print = darkroom::print_command(opened);
    const auto server = darkroom::Server::open(**engine, served);
    if (!server) return cli::fail(server.error());
    cli::print(introduction(**server, served.folder, common.json));
    std::fflush(stdout);
    if (opens.value_or(has_desktop())) open_in_browser((*server)->address());

    std::thread waiting([&] {
        int signal = 0;
        sigwait(&ends, &signal);
        (*server)->stop();
    });
    (*server)->run();
    waiting.join();
    return cli::kDone;
} catch (...) {
    return latent::cli::fail_with_exception();
}
