// tests/render/textures.h: textures of scenes written on the spot, evaluated at points.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "render/texture/textures.h"
#include "tests/render/scenes.h"

namespace latent::render::testing {

// Textures of a scene: "t" is a float texture, "s" a spectrum one.
class TextureTest : public ::testing::Test {
 protected:
    // The exponent of a phong material is `t`, its Kd `s`; `more` defines them.
    void load(const std::string& more, std::uint64_t cache_bytes = 1 << 20) {
        const Result<LoadedScene> scene = load_scene(folder_.write("room.pbrt", "WorldBegin\n" + more + R"(
Texture "s2" "spectrum" "constant"
Texture "t2" "float" "constant"
Material "phong" "texture exponent" "t" "texture Kd" "s"
Shape "sphere"
)"));
        ASSERT_TRUE(scene) << scene.error().message;
        scene_ = scene->description;
        Result<Textures> textures = Textures::build(scene_, cache_bytes, library_);
        ASSERT_TRUE(textures) << textures.error().message;
        textures_.emplace(std::move(*textures));
        const MaterialDescription& material = scene_.materials[scene_.shapes[0].material];
        number_ = textures_->source(material.number("exponent"));
        spectrum_ = textures_->source(material.spectra.at("Kd"), library_);
        spectra_.emplace(library_);
        Wavelengths& w = spectra_->wavelengths;
        w.k = kMaxWavelengths;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            w.below[i] = w.nearest[i] = 14 * i + 10;
            w.fraction[i] = 0;
            w.lambda_nm[i] = 370 + 14 * static_cast<float>(i);
        }
        spectra_->start_sample();
        point_.spectra = &*spectra_;
    }
    void load_float(const std::string& t, std::uint64_t cache_bytes = 1 << 20) {
        load("Texture \"t\" \"float\" " + t + "\nTexture \"s\" \"spectrum\" \"constant\"\n", cache_bytes);
    }
    void load_spectrum(const std::string& s) {
        load("Texture \"t\" \"float\" \"constant\"\nTexture \"s\" \"spectrum\" " + s + "\n");
    }
    float at(float u, float v, float width = 0) {
        point_.uv = {u, v};
        point_.duvdx = {width, 0};
        point_.duvdy = {0, width};
        return number_.at(point_);
    }
    float at(const Vec3f& p) {
        point_.p = p;
        return number_.at(point_);
    }
    const SampledSpectrum& spectrum_at(float u, float v) {
        point_.uv = {u, v};
        return spectrum_.at(point_);
    }
    // A grey picture of floats.
    void write_floats(const std::string& name, int width, int height, const std::vector<float>& rows_from_the_bottom) const {
        folder_.write(name, fmt::format("Pf\n{} {}\n-1.0\n", width, height) +
                                std::string(reinterpret_cast<const char*>(rows_from_the_bottom.data()),
                                            rows_from_the_bottom.size() * sizeof(float)));
    }
    // A grey picture of 8 bits.
    void write_grey(const std::string& name, int width, int height, const std::vector<int>& values) const {
        std::string bytes = fmt::format("P5\n{} {}\n255\n", width, height);
        for (const int x : values) bytes += static_cast<char>(x);
        folder_.write(name, bytes);
    }

    Folder folder_;
    SceneDescription scene_;
    SpectrumLibrary library_;
    std::optional<Textures> textures_;
    std::optional<SampledSpectra> spectra_;
    FloatSource number_;
    SpectrumSource spectrum_;
    TexturePoint point_{};
};

}  // namespace latent::render::testing
