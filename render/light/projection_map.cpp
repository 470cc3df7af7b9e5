#include "render/light/projection_map.h"

#include <algorithm>

namespace latent::render {

ProjectionMap::ProjectionMap(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light, double fov_degrees,
                             SpectrumLibrary& library, color::RgbSpectra kind)
    : image_(std::move(image)),
      world_from_light_(Affined(normalize(world_from_light.x), normalize(world_from_light.y), normalize(world_from_light.z), {})),
      light_from_world_(*world_from_light_.inverse()),
      colors_(library, kind) {
    const double width = image_->width, height = image_->height, reach = std::tan(fov_degrees * std::numbers::pi / 360);
    reach_x_ = reach * std::max(1.0, width / height);
    reach_y_ = reach * std::max(1.0, height / width);
    std::vector<double> weight(image_->rgb.size() / 3);
    // The solid angle of the rectangle between the axis and (x, y).
    const auto solid_angle = [](double x, double y) { return std::atan(x * y / std::sqrt(1 + x * x + y * y)); };
    for (std::size_t i = 0; i < weight.size(); ++i) {
        const double x0 = (static_cast<double>(i % image_->width) / width * 2 - 1) * reach_x_, x1 = x0 + 2 * reach_x_ / width,
                     y0 = (static_cast<double>(i / image_->width) / height * 2 - 1) * reach_y_, y1 = y0 + 2 * reach_y_ / height;
        weight[i] = luminance(&image_->rgb[3 * i]) *
                    (solid_angle(x1, y1) - solid_angle(x0, y1) - solid_angle(x1, y0) + solid_angle(x0, y0));
        luminous_intensity_ += weight[i];
    }
    const double mean = luminous_intensity_ / static_cast<double>(weight.size());
    pixels_ = PixelDistribution(std::move(weight), image_->width, mean);
}

float ProjectionMap::corner() const { return static_cast<float>(1 - 1 / std::sqrt(1 + reach_x_ * reach_x_ + reach_y_ * reach_y_)); }

// The first row is at the top, where y is greatest.
Vec3f ProjectionMap::sample(Uniform u, Uniform v) const {
    const auto [x, y, in_x, in_y] = pixels_.sample(u, v);
    const auto centred = [](std::uint32_t i, Uniform within, std::uint32_t size) {
        return (i + static_cast<double>(static_cast<float>(within))) / size * 2 - 1;
    };
    const Vec3d local(centred(x, in_x, image_->width) * reach_x_, -centred(y, in_y, image_->height) * reach_y_, 1);
    return normalize(world_from_light_.vector(Vec3f(normalize(local))));
}

bool ProjectionMap::find(const Vec3f& w, Place& out) const {
    const Vec3f local = light_from_world_.vector(w);
    if (!(local.z > 1e-3f)) return false;
    const double x = static_cast<double>(local.x) / static_cast<double>(local.z),
                 y = static_cast<double>(local.y) / static_cast<double>(local.z);
    const double s = 0.5 * (1 + x / reach_x_), t = 0.5 * (1 - y / reach_y_);
    if (!(s >= 0 && s < 1 && t >= 0 && t < 1)) return false;
    const double across = 1 + x * x + y * y;
    out = {std::min(static_cast<std::uint32_t>(s * image_->width), image_->width - 1),
           std::min(static_cast<std::uint32_t>(t * image_->height), image_->height - 1),
           static_cast<float>(across * std::sqrt(across))};
    return true;
}

float ProjectionMap::pdf_omega(const Vec3f& w) const {
    Place p;
    if (!find(w, p)) return 0;
    return static_cast<float>(pixels_.density(p.x, p.y) / (4 * reach_x_ * reach_y_)) * p.area_per_solid_angle;
}

bool ProjectionMap::multiply(const Vec3f& w, SampledSpectra& spectra, SampledSpectrum& value) const {
    Place p;
    if (!find(w, p)) return false;
    colors_.multiply(&image_->rgb[3 * (std::size_t{p.y} * image_->width + p.x)], spectra, value);
    return true;
}

}  // namespace latent::render
