#include "render/light/environment.h"

#include <algorithm>
#include <array>
#include <span>

namespace latent::render {
namespace {

Affinef rotation(const Affined& a) { return Affinef(Affined(normalize(a.x), normalize(a.y), normalize(a.z), {0, 0, 0})); }

double luminance(const float* rgb) {
    const auto& row = color::RgbSpace::srgb().luminance_row;
    return row[0] * static_cast<double>(rgb[0]) + row[1] * static_cast<double>(rgb[1]) + row[2] * static_cast<double>(rgb[2]);
}

// Appends the cumulative distribution of `weight`, from 0 to 1; returns the sum of the weights.
double append_cdf(const std::vector<double>& weight, std::vector<float>& cdf) {
    double sum = 0, so_far = 0;
    for (const double w : weight) sum += w;
    cdf.push_back(0);
    for (const double w : weight) cdf.push_back(static_cast<float>((so_far += w) / sum));
    cdf.back() = 1;
    return sum;
}

// The x with cdf(x) = u, linear between integers.
float inverse_cdf(std::span<const float> cdf, float u) {
    const std::size_t i = static_cast<std::size_t>(std::upper_bound(cdf.begin() + 1, cdf.end() - 1, u) - cdf.begin()) - 1;
    return std::min(static_cast<float>(i) + (u - cdf[i]) / (cdf[i + 1] - cdf[i]), std::nextafter(static_cast<float>(i + 1), 0.0f));
}

}  // namespace

Environment::Environment(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light, SpectrumLibrary& library)
    : image_(std::move(image)), world_from_light_(rotation(world_from_light)), light_from_world_(*world_from_light_.inverse()) {
    const color::RgbToSpectrum to_spectrum(color::RgbSpace::srgb(), color::illuminant_d65());
    const color::Rgb colours[6] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
    for (int c = 0; c < 6; ++c) {
        const color::SigmoidSpectrum sigmoid = to_spectrum.reflectance(colours[c]);
        const auto value = [&](double nm) { return sigmoid(static_cast<float>(nm)); };
        basis_[c] = library.add(color::Spectrum::from_function(value, color::Outside::kClamped), Lookup::kLinear);
    }
    std::vector<double> weight(std::size_t{image_->width} * image_->height);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = std::max(0.0, luminance(&image_->rgb[3 * i]));
    for (const double w : weight) mean_luminance_ += w / static_cast<double>(weight.size());
    // Nothing that shines is never drawn, whatever its luminance; a tenth goes anywhere.
    for (double& w : weight) w = 0.9 * w + 0.1 * std::max(mean_luminance_, 1e-30);
    const std::size_t w = image_->width;
    std::vector<double> rows;
    for (std::uint32_t y = 0; y < image_->height; ++y) {
        const std::vector<double> row(weight.begin() + static_cast<std::ptrdiff_t>(y * w),
                                      weight.begin() + static_cast<std::ptrdiff_t>((y + 1) * w));
        rows.push_back(append_cdf(row, column_cdf_));
    }
    append_cdf(rows, row_cdf_);
    for (std::uint32_t y = 0; y < image_->height; ++y) {
        for (std::size_t x = 0; x < w; ++x) {
            const std::size_t c = y * (w + 1) + x;
            probability_.push_back((row_cdf_[y + 1] - row_cdf_[y]) * (column_cdf_[c + 1] - column_cdf_[c]));
        }
    }
}

Vec2f Environment::square_of(const Vec3f& w) const { return square_from_sphere(normalize(light_from_world_.vector(w))); }

std::size_t Environment::pixel(const Vec2f& p) const {
    const std::uint32_t x = std::min(static_cast<std::uint32_t>(p.x * static_cast<float>(image_->width)), image_->width - 1);
    const std::uint32_t y = std::min(static_cast<std::uint32_t>(p.y * static_cast<float>(image_->height)), image_->height - 1);
    return std::size_t{y} * image_->width + x;
}

Vec3f Environment::sample(float u, float v) const {
    const float y = inverse_cdf(std::span(row_cdf_), v);
    const std::size_t row = std::min(static_cast<std::size_t>(y), std::size_t{image_->height} - 1), w = image_->width;
    const float x = inverse_cdf(std::span(column_cdf_).subspan(row * (w + 1), w + 1), u);
    return normalize(
        world_from_light_.vector(sphere_from_square({x / static_cast<float>(w), y / static_cast<float>(image_->height)})));
}

float Environment::pdf_omega(const Vec3f& w) const {
    return probability_[pixel(square_of(w))] * static_cast<float>(probability_.size()) * kInv4Pi;
}

void Environment::multiply(const Vec3f& w, SampledSpectra& spectra, Batch& value) const {
    const float* rgb = &image_->rgb[3 * pixel(square_of(w))];
    std::array<int, 3> order = {0, 1, 2};  // by falling value
    if (rgb[order[0]] < rgb[order[1]]) std::swap(order[0], order[1]);
    if (rgb[order[1]] < rgb[order[2]]) std::swap(order[1], order[2]);
    if (rgb[order[0]] < rgb[order[1]]) std::swap(order[0], order[1]);
    const float white = rgb[order[2]], secondary = rgb[order[1]] - white, primary = rgb[order[0]] - rgb[order[1]];
    const Batch& first = spectra[basis_[order[0]]];
    const Batch& second = spectra[basis_[3 + order[2]]];  // the complement of the smallest component
    for (std::uint32_t i = 0; i < kLanes; ++i) value.v[i] *= white + secondary * second.v[i] + primary * first.v[i];
}

double Environment::upper_illuminance() const {
    double sum = 0;
    for (std::uint32_t y = 0; y < image_->height; ++y) {
        for (std::uint32_t x = 0; x < image_->width; ++x) {
            const Vec2f p{(static_cast<float>(x) + 0.5f) / static_cast<float>(image_->width),
                          (static_cast<float>(y) + 0.5f) / static_cast<float>(image_->height)};
            const float cosine = sphere_from_square(p).z;
            if (cosine > 0) sum += static_cast<double>(cosine) * luminance(&image_->rgb[3 * (std::size_t{y} * image_->width + x)]);
        }
    }
    return sum * 4 * std::numbers::pi / static_cast<double>(probability_.size());
}

}  // namespace latent::render
