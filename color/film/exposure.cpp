#include "color/film/exposure.h"

#include <fmt/format.h>

#include "color/film/spectra.h"
#include "color/power_of_ten.h"

namespace latent::film {

Result<color::Observer> film_observer(const Material& material, double exposure_index) {
    std::vector<std::string> layers{"log10_r", "log10_g", "log10_b"};
    if (!material.colour) layers.assign(3, "log10_sensitivity");
    const Result<Columns> table = need_table(material, "sensitivity", layers);
    if (!table) return table.error();
    const color::Spectrum balance = light_spectrum(material.balance);
    const double luminance = color::xyz_from_spectrum(balance, color::Observer::cie1931()).y;
    color::ResponseTable responses{.name = material.name,
                                   .kind = color::ObserverKind::kLayers,
                                   .lambda_nm = table->values[0],
                                   .response = std::vector<std::array<double, 3>>(table->values[0].size())};
    constexpr double kGreyCard = 0.18, kExposureOfGrey = 10;
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> s;
        for (const double log_s : (*table)[layers[c]]) s.push_back(log_s > -9 ? color::power_of_ten(log_s) : 0);
        const Result<color::Spectrum> layer = color::Spectrum::from_samples(table->values[0], s, color::Outside::kZero);
        if (!layer) return layer.error();
        const double seen = color::integral_of_product(balance, *layer) / luminance;
        if (!(seen > 0))
            return Error{ErrorCode::kCorrupt, fmt::format("{}: {}: does not respond to {}, the light that the film is balanced for",
                                                          table_file(material, "sensitivity"), layers[c], material.balance)};
        for (std::size_t i = 0; i < s.size(); ++i)
            responses.response[i][c] = s[i] * kExposureOfGrey / (exposure_index * kGreyCard * seen);
    }
    return color::Observer::as_given(std::move(responses));
}

}  // namespace latent::film
