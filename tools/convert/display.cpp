#include "tools/convert/display.h"

#include <filesystem>

namespace latent::convert {

Result<Display> display_from(const std::string& text, const std::optional<std::array<double, 3>>& luminance_row) {
    const std::string extension = std::filesystem::path(text).extension().string();
    if (extension == ".icc" || extension == ".icm" || extension == ".ICC" || extension == ".ICM")
        return display_from_icc(text, luminance_row);
    Result<color::RgbSpace> space = color::RgbSpace::parse(text);
    if (!space) return space.error().at("--profile");
    if (luminance_row) {
        space = color::RgbSpace::from_matrix(space->name, space->rgb_from_xyz, &*luminance_row, space->transfer);
        if (!space) return space.error().at("--luminance-row");
    }
    Display display;
    display.space = *space;
    display.white = space->primaries.white;
    display.icc = icc_of(*space);
    display.srgb = text == "srgb" && !luminance_row;
    if (text == "display-p3") display.cicp = {12, 13, 0, 1};
    return display;
}

}  // namespace latent::convert
