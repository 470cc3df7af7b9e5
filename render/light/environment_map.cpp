#include "render/light/environment_map.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

namespace latent::render {
namespace {

Affinef rotation(const Affined& a) { return Affinef(Affined(normalize(a.x), normalize(a.y), normalize(a.z), {0, 0, 0})); }

}  // namespace

EnvironmentMap::EnvironmentMap(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light,
                               SpectrumLibrary& library)
    : image_(std::move(image)),
      world_from_light_(rotation(world_from_light)),
      light_from_world_(*world_from_light_.inverse()),
      colors_(library) {
    std::vector<double> weight(std::size_t{image_->width} * image_->height);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = std::max(0.0, luminance(&image_->rgb[3 * i]));
    for (const double w : weight) mean_luminance_ += w / static_cast<double>(weight.size());
    // Nothing that shines is never drawn, whatever its luminance; a tenth goes anywhere.
    for (double& w : weight) w = 0.9 * w + 0.1 * std::max(mean_luminance_, 1e-30);
    std::vector<double> rows;
    for (std::uint32_t y = 0; y < image_->height; ++y) {
        const auto row = std::span<const double>(weight).subspan(std::size_t{y} * image_->width, image_->width);
        rows.push_back(std::accumulate(row.begin(), row.end(), 0.0));
        columns_.emplace_back(row);
    }
    rows_ = PiecewiseConstant(rows);
}

EnvironmentMap::Pixel EnvironmentMap::pixel(const Vec3f& w) const {
    const Vec2f p = centred_from_sphere(normalize(light_from_world_.vector(w)));
    const auto index = [](float x, std::uint32_t size) {
        return std::min(static_cast<std::uint32_t>(std::max(0.5 * (1 + static_cast<double>(x)) * size, 0.0)), size - 1);
    };
    return {index(p.x, image_->width), index(p.y, image_->height)};
}

Vec3f EnvironmentMap::sample(Uniform u, Uniform v) const {
    Uniform in_x, in_y;
    const std::uint32_t y = rows_.sample(v, in_y), x = columns_[y].sample(u, in_x);
    // From the centre of the square, so that the pixels about +z are as exact as others.
    const auto centred = [](std::uint32_t i, float within, std::uint32_t size) {
        return (static_cast<float>(2 * std::int64_t{i} - size) + 2 * within) / static_cast<float>(size);
    };
    const Vec2f p{centred(x, in_x, image_->width), centred(y, in_y, image_->height)};
    return normalize(world_from_light_.vector(sphere_from_centred(p)));
}

float EnvironmentMap::pdf_omega(const Vec3f& w) const {
    const Pixel p = pixel(w);
    const double pixels = static_cast<double>(image_->width) * image_->height;
    return static_cast<float>(rows_.probability(p.y) * columns_[p.y].probability(p.x) * pixels / (4 * std::numbers::pi));
}

void EnvironmentMap::multiply(const Vec3f& w, SampledSpectra& spectra, SampledSpectrum& value) const {
    const Pixel p = pixel(w);
    colors_.multiply(&image_->rgb[3 * (std::size_t{p.y} * image_->width + p.x)], spectra, value);
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
