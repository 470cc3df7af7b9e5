#include "render/texture/textures.h"

#include "render/texture/combine.h"

namespace latent::render {

// Builds each texture after its inputs, which render/scene/check.h has found to form no circle.
struct Textures::Builder {
    const SceneDescription& scene;
    SpectrumLibrary& library;
    Textures& out;

    FloatSource source(const FloatInput& input) {
        if (input.is_textured()) build(input.texture);
        return out.source(input);
    }
    SpectrumSource source(const SpectrumInput& input) {
        if (input.is_textured()) build(input.texture);
        return out.source(input, library);
    }
    FloatSource input_of(float, const TextureDescription& d, int i) { return source(d.numbers[i]); }
    SpectrumSource input_of(const SampledSpectrum*, const TextureDescription& d, int i) { return source(d.spectra[i]); }

    template <class Value>
    std::unique_ptr<Texture<Value>> make(const TextureDescription& d) {
        const auto input = [&](int i) { return input_of(Value{}, d, i); };
        switch (d.kind) {
            case TextureKind::kConstant:
                return std::make_unique<Constant<Value>>(input(0));
            case TextureKind::kScale:
                return std::make_unique<Scale<Value>>(input(0), source(d.amount));
            case TextureKind::kMix:
                return std::make_unique<Mix<Value>>(input(0), input(1), source(d.amount));
        }
        __builtin_unreachable();
    }
    void build(std::uint32_t i) {
        const TextureDescription& d = scene.textures[i];
        if (d.is_spectrum && !out.spectra_[i]) out.spectra_[i] = make<const SampledSpectrum*>(d);
        if (!d.is_spectrum && !out.floats_[i]) out.floats_[i] = make<float>(d);
    }
};

Result<Textures> Textures::build(const SceneDescription& scene, SpectrumLibrary& library) {
    Textures out;
    out.floats_.resize(scene.textures.size());
    out.spectra_.resize(scene.textures.size());
    Builder builder{scene, library, out};
    for (std::uint32_t i = 0; i < scene.textures.size(); ++i) builder.build(i);
    return out;
}

FloatSource Textures::source(const FloatInput& input) const {
    if (!input.is_textured()) return {input.value, nullptr};
    return {0, floats_[input.texture].get()};
}

SpectrumSource Textures::source(const SpectrumInput& input, SpectrumLibrary& library) const {
    if (!input.is_textured()) return {library.add(input.value, Lookup::kLinear), nullptr};
    return {0, spectra_[input.texture].get()};
}

}  // namespace latent::render
