#include "render/material/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/hash.h"

namespace latent::render {
namespace {

// Inputs of a mixture: the share of the second material, or a selector that varies with wavelength.
enum : std::size_t { kAmount, kSelector };
constexpr std::array kMixture = {Input::number("amount", 0.5f, 0, 1), Input{.name = "selector", .may_be_missing = true}};

// The nearest value within the input's range, of no number the lowest.
float within(const Input& input, float x) { return x > input.low ? std::min(x, input.high) : input.low; }

bool varies_with_wavelength(const color::Spectrum& eta) {
    const double first = eta(color::kLambdaMin);
    for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm) {
        if (eta(nm) != first) return true;
    }
    return false;
}

// Loaders name closures and their inputs as text: a slip there is found when the first such material is built.
void check_names(const MaterialDescription& d, std::span<const Input> inputs, const auto& described, InputRole role) {
    for (const auto& item : described) {
        if (std::ranges::none_of(inputs, [&](const Input& input) { return input.name == item.first && input.role == role; }))
            throw std::logic_error(fmt::format("material type \"{}\" has no such input: {}", d.type, item.first));
    }
}

}  // namespace

Material::Material(const MaterialDescription& d, const Textures& textures, SpectrumLibrary& library)
    : measured_(d.measured ? std::make_unique<const MeasuredTables>(d.measured) : nullptr),
      mixed_(d.mixed),
      relief_(Relief::of_surface(d, textures)),
      coat_relief_(Relief::of_coat(d, textures)) {
    std::span<const Input> inputs = kMixture;
    const auto find_closure = [&]<class... C>(std::type_identity<ClosureList<C...>>) {
        (..., (C::kName == d.type ? void((make_ = &make<C>, inputs = C::kInputs)) : void()));
    };
    find_closure(std::type_identity<AnyClosure>());
    if (is_mixture() && d.type != "mix") throw std::logic_error(fmt::format("no closure has the name \"{}\"", d.type));
    check_names(d, inputs, d.numbers, InputRole::kNumber);
    check_names(d, inputs, d.spectra, InputRole::kSpectrum);
    check_names(d, inputs, d.options, InputRole::kOption);
    for (const Input& input : inputs) sources_.push_back(source(input, d, textures, library));
    is_textured_ |= is_mixture() || d.type == Hair::kName || !relief_.is_flat() || !coat_relief_.is_flat();
}

Material::Source Material::source(const Input& input, const MaterialDescription& d, const Textures& textures,
                                  SpectrumLibrary& library) {
    Source out;
    if (const auto given = d.options.find(input.name); input.role == InputRole::kOption) {
        out.option = given != d.options.end() ? given->second : static_cast<std::uint32_t>(input.otherwise);
    } else if (input.role == InputRole::kNumber) {
        out.number = textures.source(d.number(input.name, input.otherwise));
        out.number.value = within(input, out.number.value);
        out.is_root = input.is_alpha && d.remap_roughness;
        is_textured_ |= input.is_directed && out.number.value != 0;
    } else if (const auto spectrum = d.spectra.find(input.name); spectrum != d.spectra.end() || !input.may_be_missing) {
        const SpectrumInput described = spectrum != d.spectra.end() ? spectrum->second : SpectrumInput();
        out.spectrum = textures.source(described, library);
        out.factor = d.number(input.factor, 1).value;
        out.is_there = true;
        out.varies = input.is_index && varies_with_wavelength(described.value);
        disperses_ |= out.varies;
    }
    is_textured_ |= out.number.texture != nullptr || out.spectrum.texture != nullptr;
    return out;
}

const SampledSpectrum& Material::spectrum(const Input& input, const Source& source, const TexturePoint& point) {
    const SampledSpectrum& given = source.spectrum.at(point);
    if (source.spectrum.texture == nullptr && source.factor == 1) return given;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = within(input, source.factor * given.v[i]);
    return out;
}

float Material::number(const Input& input, const Source& source, const TexturePoint& point) {
    if (source.number.texture == nullptr) return source.number.value;
    const float given = within(input, source.number.at(point));
    return source.is_root ? std::sqrt(given) : given;
}

std::uint32_t Material::chosen(const TexturePoint& point, std::uint32_t depth, const SampledSpectrum*& weight) const {
    // No place is told from another one by less than its last bits, so this is as good as chance.
    std::byte bytes[16];
    store_le(bytes, std::bit_cast<std::uint32_t>(point.p.x));
    store_le(bytes + 4, std::bit_cast<std::uint32_t>(point.p.y));
    store_le(bytes + 8, std::bit_cast<std::uint32_t>(point.p.z));
    store_le(bytes + 12, depth);
    const auto identity = std::span<const std::byte>(bytes).first(depth == 0 ? 12 : 16);
    const float u = static_cast<float>(hash64(identity) >> 40) * 0x1p-24f;
    if (!sources_[kSelector].is_there) return mixed_[u < number(kMixture[kAmount], sources_[kAmount], point) ? 1 : 0];
    // Wavelengths are drawn about as the eye sees them, so their mean is the selector's luminance [R06 5.3.5].
    const SampledSpectrum& share = spectrum(kMixture[kSelector], sources_[kSelector], point);
    const std::uint32_t k = point.spectra->wavelengths.k;
    float mean = 0;
    for (std::uint32_t i = 0; i < k; ++i) mean += share.v[i] / static_cast<float>(k);
    const bool second = u < mean;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        out.v[i] = (second ? share.v[i] / mean : (1 - share.v[i]) / (1 - mean)) * (weight != nullptr ? weight->v[i] : 1);
    }
    weight = &out;
    return mixed_[second ? 1 : 0];
}

template <Closure C>
Bsdf Material::make(const Material& material, const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) {
    Values<C> values(
        {*point.spectra, kept, hit.p, hit.ribbon, hit.ribbon ? hit.across : 0, hit.mirrored, material.measured_.get()});
    const auto evaluate = [&]<std::size_t I>() {
        constexpr const Input& kInput = C::kInputs[I];
        const Source& source = material.sources_[I];
        if constexpr (kInput.role == InputRole::kOption) {
            values[I].option = source.option;
        } else if constexpr (kInput.role == InputRole::kNumber) {
            values[I].number = number(kInput, source, point);
        } else {
            if (!kInput.may_be_missing || source.is_there) values[I].spectrum = &spectrum(kInput, source, point);
            values[I].varies = source.varies;
        }
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) { (evaluate.template operator()<I>(), ...); }
    (std::make_index_sequence<C::kInputs.size()>());
    bool is_isotropic = true;
    if constexpr (requires { C::is_isotropic(values); }) is_isotropic = C::is_isotropic(values);
    return Bsdf(is_isotropic ? Frame::from_z(hit.ns) : Frame::from_z_x(hit.ns, hit.dpdu), hit.ng, C(values));
}

}  // namespace latent::render
