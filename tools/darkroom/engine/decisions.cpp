#include "tools/darkroom/engine/decisions.h"

#include <variant>

#include "base/recipe_options.h"
#include "tools/convert/arguments.h"
#include "tools/develop/arguments.h"

namespace latent::darkroom {

std::string Decisions::of_light() const {
    const auto section = recipe.find("develop");
    nlohmann::json sorted = section == recipe.end() ? nlohmann::json::object() : nlohmann::json(*section);
    for (const char* key : {"size", "crop", "mipmap", "compression"}) sorted.erase(key);
    return sorted.dump(-1, ' ', true);
}

bool Decisions::spreads_light() const {
    return print.glare || !print.darkroom.look.empty() || print.darkroom.mtf.value_or(false) ||
           print.darkroom.halation.value_or(convert::Halation::kNone) != convert::Halation::kNone;
}

Result<Decisions> decide(const Recipe& recipe) {
    Decisions decisions;
    CLI::App app{"", "latent-print"};
    develop::add_decisions(app, decisions.picture);
    convert::add_decisions(app, decisions.print);
    app.add_flag_callback("--recipe", [&] { cli::apply_recipe(app, "recipe", recipe); });
    try {
        app.parse(std::vector<std::string>{"--recipe"});
    } catch (const CLI::ParseError& error) {
        return usage_error(cli::in_plain_words(error));
    }
    decisions.recipe = recipe;
    return decisions;
}

Status check_view(const Decisions& decisions) {
    const convert::ConvertOptions& print = decisions.print;
    if (decisions.picture.frames > 1) return usage_error("--frames: a view shows one picture; use latent-develop");
    if (decisions.picture.focus && decisions.picture.focus->pixel)
        return usage_error("--focus: a view needs a distance; its pixels have another size than those of the print");
    if (print.level > 0) return usage_error("--level: a view has the sizes that are asked for");
    if (print.white && std::holds_alternative<image::Rect>(*print.white))
        return usage_error("--white: a view needs a chromaticity; its pixels have another size than those of the print");
    return {};
}

}  // namespace latent::darkroom
