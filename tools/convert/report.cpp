#include "tools/convert/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.h"
#include "base/size.h"

namespace latent::convert {

namespace {

std::string exposure_text(const ExposureReport& r, bool gamut_report) {
    const auto share = [&](std::uint64_t count) {
        return 100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, r.print.pixels));
    };
    std::string text = fmt::format("black          {} ({:.3f} %)\nburnt          {} ({:.3f} %)\n", counted(r.print.black, "pixel"),
                                   share(r.print.black), counted(r.print.burnt, "pixel"), share(r.print.burnt));
    text += fmt::format("out of gamut   {} ({:.3f} %)\n", counted(r.print.out_of_gamut, "pixel"), share(r.print.out_of_gamut));
    if (gamut_report)
        text += fmt::format("hue            shifted by {:.1f} degrees at most, at {},{}; by more than 10 in {} ({:.3f} %)\n",
                            r.hue_shifts.largest_degrees, r.hue_shifts.x, r.hue_shifts.y,
                            counted(r.hue_shifts.above_10_degrees, "pixel"), share(r.hue_shifts.above_10_degrees));
    const auto line = [&](const char* name, std::uint64_t count, const char* became) {
        if (count > 0) text += fmt::format("{:<15}{} ({:.3f} %), {}\n", name, counted(count, "pixel"), share(count), became);
    };
    line("clipped", r.print.clipped, "luminance and hue not preserved");
    line("negative", r.print.negative, "printed black");
    line("not a number", r.print.nan, "printed black");
    line("infinite", r.print.infinite, "printed white");
    line("colourless", r.print.colourless, "x or z not finite, printed grey");
    for (const std::string& output : r.outputs) text += fmt::format("written        {}\n", output);
    return text;
}

nlohmann::ordered_json json_of(const ExposureReport& r, bool gamut_report) {
    nlohmann::ordered_json json{
        {"black", r.print.black},       {"burnt", r.print.burnt},          {"out_of_gamut", r.print.out_of_gamut},
        {"clipped", r.print.clipped},   {"negative", r.print.negative},    {"not_a_number", r.print.nan},
        {"infinite", r.print.infinite}, {"colourless", r.print.colourless}};
    if (gamut_report)
        json["hue_shift"] = {{"largest_degrees", r.hue_shifts.largest_degrees},
                             {"at", {r.hue_shifts.x, r.hue_shifts.y}},
                             {"above_10_degrees", r.hue_shifts.above_10_degrees}};
    json["outputs"] = r.outputs;
    return json;
}

}  // namespace

std::string to_text(const ConvertReport& r) {
    std::string text = fmt::format("size           {} x {}\n", r.width, r.height);
    text += fmt::format("print          tone {}, gamut {}, {}\nwhite          {}, {}\n", r.tone, r.gamut, r.profile,
                        text_of(r.white), r.adapt);
    if (r.dpi > 0) text += fmt::format("paper          {} pixels per inch\n", r.dpi);
    if (!r.observer.empty()) text += fmt::format("observer       {}\n", r.observer);
    if (!r.film.empty()) text += fmt::format("film           {}\n", r.film);
    if (r.dodged > 0) text += fmt::format("dodged         {}\n", counted(r.dodged, "part"));
    if (!r.vignette.empty()) text += fmt::format("vignette       {}\n", r.vignette);
    if (!r.glare.empty()) text += fmt::format("glare          {}\n", r.glare);
    if (!r.shown.empty()) text += fmt::format("shown          {}\n", r.shown);
    if (!r.proof.empty()) text += fmt::format("proof          {}\n", r.proof);
    if (r.rendering) {
        const char* compensated = r.rendering->compensates() ? "with" : "without";
        text += fmt::format("intent         {}", name_of(r.rendering->intent));
        if (r.rendering->intent != Intent::kAbsolute) text += fmt::format(", {} black point compensation", compensated);
        text += "\n";
    }
    if (r.contrast != 1 || r.black_point != 0)
        text += fmt::format("contrast       {}, black below {}\n", r.contrast, r.black_point);
    text += "luminance      ";
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
        text += fmt::format("{}{} %: {:.3g}", i == 0 ? "" : ", ", kPercentiles[i], r.luminance[i]);
    text += "\n";
    // As -s and --stops take them: the first number gives this print again.
    const auto sensitivity = [](double sigma) { return fmt::format("{} ({:+.2f} EV)", sigma, std::log2(sigma)); };
    const auto add = [&](const ExposureReport& exposure) {
        text += "sensitivity    " + sensitivity(exposure.sigma);
        if (r.chose_exposure && r.auto_sigma) text += ", chosen from the picture";
        if (!r.chose_exposure && r.auto_sigma && *r.auto_sigma != exposure.sigma)
            text += fmt::format("; --auto would choose {}", sensitivity(*r.auto_sigma));
        text += "\n" + exposure_text(exposure, r.gamut_report);
    };
    add(r);
    for (const ExposureReport& other : r.others) add(other);
    return text;
}

std::string to_json(const ConvertReport& r) {
    nlohmann::ordered_json luminance;
    for (std::size_t i = 0; i < kPercentiles.size(); ++i) luminance[fmt::format("p{}", kPercentiles[i])] = r.luminance[i];
    nlohmann::ordered_json json{{"width", r.width},      {"height", r.height},       {"sensitivity", r.sigma},
                                {"tone", r.tone},        {"contrast", r.contrast},   {"black_point", r.black_point},
                                {"gamut", r.gamut},      {"profile", r.profile},     {"white", {r.white.x, r.white.y}},
                                {"adaptation", r.adapt}, {"pixels", r.print.pixels}, {"luminance", luminance}};
    if (r.dpi > 0) json["dpi"] = r.dpi;
    json["exposure_ev"] = std::log2(r.sigma);
    if (r.auto_sigma) json["auto_sensitivity"] = *r.auto_sigma;
    if (!r.observer.empty()) json["observer"] = r.observer;
    if (!r.film.empty()) json["film"] = r.film;
    if (r.dodged > 0) json["dodged"] = r.dodged;
    if (!r.vignette.empty()) json["vignette"] = r.vignette;
    if (!r.glare.empty()) json["glare"] = r.glare;
    if (!r.shown.empty()) json["shown"] = r.shown;
    if (!r.proof.empty()) json["proof"] = r.proof;
    if (r.rendering) json["intent"] = name_of(r.rendering->intent);
    if (r.rendering && r.rendering->intent != Intent::kAbsolute) json["black_point_compensation"] = r.rendering->compensates();
    json.update(json_of(r, r.gamut_report));
    json["seconds"] = r.seconds;
    for (const ExposureReport& other : r.others) {
        nlohmann::ordered_json exposure{{"stops", other.stops}, {"sensitivity", other.sigma}};
        exposure.update(json_of(other, r.gamut_report));
        json["other_exposures"].push_back(exposure);
    }
    return json_text(json) + "\n";
}

std::vector<std::string> losses(const ConvertReport& r) {
    if (r.damaged() == 0) return {};
    return {counted(r.damaged(), "pixel") + (r.damaged() == 1 ? " was" : " were") + " not finite"};
}

}  // namespace latent::convert
