// base/help.h: how --help sets options: "--filter NAME", "--integrator path|bdpt", "--quality 1..100 [90]" with the default in
// brackets.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace latent::cli {

class HelpFormatter final : public CLI::Formatter {
 public:
    HelpFormatter() { column_width(38); }
    std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_footer(const CLI::App* app) const override;
};

}  // namespace latent::cli
