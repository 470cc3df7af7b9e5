#include "base/help.h"

#include <gtest/gtest.h>

#include "base/cli.h"

namespace latent {
namespace {

TEST(Help, AnOptionShowsWhatItTakesAndItsDefault) {
    CLI::App app;
    int quality = 90;
    double light = 0;
    std::uint64_t seed = 0, memory = 0;
    std::string file, range, gamut = "grey";
    std::vector<std::string> parts;
    bool dither = true;
    app.add_option("PART", parts)->required();
    app.add_option("-o,--output", file)->required()->check(cli::ends_in(".latent"));
    app.add_option("--samples", range)->type_name("A:B");
    app.add_option("--gamut", gamut)->check(CLI::IsMember({"grey", "clip"}))->capture_default_str();
    app.add_option("--quality", quality)->check(CLI::Range(1, 100))->capture_default_str();
    app.add_option("--light", light);
    app.add_option("--seed", seed)->check(cli::whole_number());
    app.add_flag("--dither,!--no-dither", dither);
    cli::add_size(app, "--memory", memory, "")->default_str("1G");
    const cli::HelpFormatter formatter;
    std::string lines;
    for (const CLI::Option* option : app.get_options()) {
        lines += formatter.make_option_name(option, option->get_positional()) + formatter.make_option_opts(option) + "\n";
    }
    EXPECT_EQ(lines,
              "-h,--help\nPART ...\n-o,--output NAME.latent (required)\n--samples A:B\n--gamut grey|clip [grey]\n"
              "--quality 1..100 [90]\n--light X\n--seed N\n--dither,--no-dither\n--memory SIZE [1G]\n");
}

}  // namespace
}  // namespace latent
