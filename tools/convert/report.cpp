#include "tools/convert/report.h"

#include <fmt/format.h>

#include "base/json.h"

namespace latent::convert {

std::string to_text(const ConvertReport& r) {
    const auto share = [&](std::uint64_t count) {
        return 100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, r.print.pixels));
    };
    std::string text =
        fmt::format("size           {} x {}\nsensitivity    {}\nprint          tone {}, gamut {}, {}\nwhite          {}, {}\n",
                    r.width, r.height, r.sigma, r.tone, r.gamut, r.profile, text_of(r.white), r.adapt);
    text += "luminance      ";
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
        text += fmt::format("{}{} %: {:.3g}", i == 0 ? "" : ", ", kPercentiles[i], r.luminance[i]);
    text += fmt::format("\nblack          {} pixels ({:.3f} %)\nburnt          {} pixels ({:.3f} %)\n", r.black, share(r.black),
                        r.burnt, share(r.burnt));
    text += fmt::format("out of gamut   {} pixels ({:.3f} %)\n", r.print.out_of_gamut, share(r.print.out_of_gamut));
    const auto line = [&](const char* name, std::uint64_t count, const char* became) {
        if (count > 0) text += fmt::format("{:<15}{} pixels ({:.3f} %), {}\n", name, count, share(count), became);
    };
    line("clipped", r.print.clipped, "luminance and hue not preserved");
    line("negative", r.print.negative, "printed black");
    line("not a number", r.print.nan, "printed black");
    line("infinite", r.print.infinite, "printed white");
    line("colourless", r.print.colourless, "x or z not finite, printed grey");
    for (const std::string& output : r.outputs) text += fmt::format("written        {}\n", output);
    return text;
}

std::string to_json(const ConvertReport& r) {
    nlohmann::ordered_json luminance;
    for (std::size_t i = 0; i < kPercentiles.size(); ++i) luminance[fmt::format("p{}", kPercentiles[i])] = r.luminance[i];
    const nlohmann::ordered_json json{{"width", r.width},
                                      {"height", r.height},
                                      {"sensitivity", r.sigma},
                                      {"tone", r.tone},
                                      {"gamut", r.gamut},
                                      {"profile", r.profile},
                                      {"white", {r.white.x, r.white.y}},
                                      {"adaptation", r.adapt},
                                      {"pixels", r.print.pixels},
                                      {"luminance", luminance},
                                      {"black", r.black},
                                      {"burnt", r.burnt},
                                      {"out_of_gamut", r.print.out_of_gamut},
                                      {"clipped", r.print.clipped},
                                      {"negative", r.print.negative},
                                      {"not_a_number", r.print.nan},
                                      {"infinite", r.print.infinite},
                                      {"colourless", r.print.colourless},
                                      {"seconds", r.seconds},
                                      {"outputs", r.outputs}};
    return json_text(json) + "\n";
}

}  // namespace latent::convert
