#include "tools/convert/vignette.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/angle.h"
#include "base/option_parts.h"
#include "base/parse.h"

namespace latent::convert {

Result<Vignette> parse_vignette(std::string_view text) {
    Vignette vignette{.text = std::string(text)};
    const auto named = named_numbers(text);
    const bool right = named && named->name == "cos4" && named->numbers.size() <= 1;
    if (right && !named->numbers.empty()) vignette.field.degrees = named->numbers.front();
    if (right && vignette.field.is_possible()) return vignette;
    return is_not(text, fmt::format("a vignette (try cos4, or cos4:54 with the degrees that the longer side of the picture covers, "
                                    "{:g} to {:g})",
                                    FieldOfView::kMin, FieldOfView::kMax));
}

FallOff::FallOff(const Vignette& vignette, const image::Rect& whole)
    : centre_x_((whole.x0 + whole.x1 - 1) / 2.0), centre_y_((whole.y0 + whole.y1 - 1) / 2.0) {
    const auto [cosine, sine] = cos_sin_of_degrees(vignette.field.degrees / 2);
    per_pixel_ = sine / cosine / (std::max(whole.width(), whole.height()) / 2.0);
}

void FallOff::apply(int x0, int y, std::span<float> row) const {
    const double up = (y - centre_y_) * per_pixel_;
    for (std::size_t i = 0; i < row.size(); ++i) {
        const double right = (x0 + static_cast<double>(i) - centre_x_) * per_pixel_, secant2 = 1 + right * right + up * up;
        row[i] = static_cast<float>(static_cast<double>(row[i]) / (secant2 * secant2));
    }
}

}  // namespace latent::convert
