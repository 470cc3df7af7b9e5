// tests/render/seen_values.h: the values of a scene's materials where a line along z meets its surface.
#pragma once

#include <optional>
#include <string>

#include "render/material/relief.h"
#include "render/texture/textures.h"
#include "tests/render/rays.h"
#include "tests/render/scenes.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {

// Places are those of the scene's file, looked at from z = 100 on; shapes have no holes.
class SeenValues {
 public:
    explicit SeenValues(const SceneDescription& description) : scene_{description}, world_(scene_.world()) {
        Result<Textures> textures = Textures::build(scene_.description, 1 << 20, library_);
        EXPECT_TRUE(textures) << textures.error().message;
        textures_.emplace(std::move(*textures));
    }

    float number(const std::string& input, double x, double y) { return textures_->source(look(x, y).number(input)).at(point_); }
    // Of the first or the second part of a mixture.
    float number_of_part(std::size_t part, const std::string& input, double x, double y) {
        const MaterialDescription& m = scene_.description.materials.at(look(x, y).mixed.at(part));
        return textures_->source(m.number(input)).at(point_);
    }
    float alpha(double x, double y) {
        look(x, y);
        return textures_->source(scene_.description.shapes.at(0).alpha).at(point_);
    }
    SampledSpectrum spectrum(const std::string& input, double x, double y) {
        const SpectrumSource source = textures_->source(look(x, y).spectra.at(input), library_);
        SampledSpectra spectra = at_wavelengths();
        TexturePoint point = point_;
        point.spectra = &spectra;
        return source.at(point);
    }
    // What a picture of one linear colour gives.
    SampledSpectrum of_rgb(const std::array<float, 3>& rgb) {
        const RgbColors colors(color::RgbSpectra::kSmooth, library_);
        SampledSpectra spectra = at_wavelengths();
        SampledSpectrum out;
        colors.evaluate(rgb.data(), SpectrumRole::kReflectance, spectra, out);
        return out;
    }
    Vec3f normal(double x, double y) { return tilted(Relief::of_surface(look(x, y), *textures_)); }
    Vec3f coat_normal(double x, double y) { return tilted(Relief::of_coat(look(x, y), *textures_)); }

 private:
    // The normal of what `look` saw.
    Vec3f tilted(const Relief& relief) {
        SurfaceHit tilted = hit_;
        relief.tilt(point_, coordinates_, tilted);
        return tilted.ns;
    }
    SampledSpectra at_wavelengths() {
        SampledSpectra spectra(library_);
        Wavelengths& w = spectra.wavelengths;
        w.k = kMaxWavelengths;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            w.below[i] = w.nearest[i] = 14 * i + 10;
            w.fraction[i] = 0;
            w.lambda_nm[i] = 370 + 14 * static_cast<float>(i);
        }
        spectra.start_sample();
        return spectra;
    }
    const MaterialDescription& look(double x, double y) {
        const Vec3f origin(Vec3d(x, y, 100) - scene_.description.origin);
        const std::optional<SurfaceHit> hit = first_hit(world_->geometry(), {origin, {0, 0, -1}});
        EXPECT_TRUE(hit) << x << " " << y;
        if (!hit) return scene_.description.materials.at(0);
        hit_ = *hit;
        coordinates_ = world_->geometry().coordinates(hit_);
        point_ = {};
        point_.p = hit_.p;
        point_.n = hit_.ns;
        point_.uv = coordinates_.uv;
        point_.vertices = coordinates_.vertices;
        return scene_.description.materials.at(hit_.material);
    }

    Scene scene_;
    std::unique_ptr<World> world_;
    SpectrumLibrary library_;
    std::optional<Textures> textures_;
    SurfaceHit hit_{};
    SurfaceCoordinates coordinates_{};
    TexturePoint point_{};
};

}  // namespace latent::render::testing
