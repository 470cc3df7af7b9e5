#include "render/light/environment_map.h"

#include <algorithm>
#include <array>

namespace latent::render {
namespace {

Affinef rotation(const Affined& a) { return Affinef(Affined(normalize(a.x), normalize(a.y), normalize(a.z), {0, 0, 0})); }

}  // namespace

EnvironmentMap::EnvironmentMap(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light,
                               SpectrumLibrary& library, color::RgbSpectra kind)
    : image_(std::move(image)),
      world_from_light_(rotation(world_from_light)),
      light_from_world_(*world_from_light_.inverse()),
      colors_(library, kind) {
    std::vector<double> weight(std::size_t{image_->width} * image_->height);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = std::max(0.0, luminance(&image_->rgb[3 * i]));
    for (const double w : weight) mean_luminance_ += w / static_cast<double>(weight.size());
    double square = 0;
    for (const double w : weight) square += w * w / static_cast<double>(weight.size());
    if (mean_luminance_ > 0) contrast_ = square / (mean_luminance_ * mean_luminance_);
    pixels_ = PixelDistribution(std::move(weight), image_->width, mean_luminance_);
}

EnvironmentMap::Pixel EnvironmentMap::pixel(const Vec3f& w) const {
    const Vec2f p = centred_from_sphere(normalize(light_from_world_.vector(w)));
    const auto index = [](float x, std::uint32_t size) {
        return std::min(static_cast<std::uint32_t>(std::max(0.5 * (1 + static_cast<double>(x)) * size, 0.0)), size - 1);
    };
    return {index(p.x, image_->width), index(p.y, image_->height)};
}

Vec3f EnvironmentMap::sample(Uniform u, Uniform v) const {
    const auto [x, y, in_x, in_y] = pixels_.sample(u, v);
    // From the centre of the square, so that the pixels about +z are as exact as others.
    const auto centred = [](std::uint32_t i, float within, std::uint32_t size) {
        return (static_cast<float>(2 * std::int64_t{i} - size) + 2 * within) / static_cast<float>(size);
    };
    const Vec2f p{centred(x, in_x, image_->width), centred(y, in_y, image_->height)};
    return normalize(world_from_light_.vector(sphere_from_centred(p)));
}

float EnvironmentMap::pdf_omega(const Vec3f& w) const {
    const Pixel p = pixel(w);
    return static_cast<float>(pixels_.density(p.x, p.y) / (4 * std::numbers::pi));
}

bool EnvironmentMap::multiply(const Vec3f& w, SampledSpectra& spectra, SampledSpectrum& value) const {
    const Pixel p = pixel(w);
    colors_.multiply(&image_->rgb[3 * (std::size_t{p.y} * image_->width + p.x)], spectra, value);
    return true;
}

double EnvironmentMap::upper_illuminance() const {
    double sum = 0;
    for (std::uint32_t y = 0; y < image_->height; ++y) {
        for (std::uint32_t x = 0; x < image_->width; ++x) {
            const Vec2f p{(static_cast<float>(x) + 0.5f) / static_cast<float>(image_->width),
                          (static_cast<float>(y) + 0.5f) / static_cast<float>(image_->height)};
            const float cosine = sphere_from_square(p).z;
            if (cosine > 0) sum += static_cast<double>(cosine) * luminance(&image_->rgb[3 * (std::size_t{y} * image_->width + x)]);
        }
    }
    return sum * 4 * std::numbers::pi / (static_cast<double>(image_->width) * image_->height);
}

}  // namespace latent::render
