#include "render/medium/make_medium.h"

#include <algorithm>
#include <functional>

#include "render/medium/cloud.h"
#include "render/medium/grid.h"
#include "render/medium/homogeneous.h"
#include "render/medium/spectral_grid.h"
#include "render/medium/sum.h"

namespace latent::render {

namespace {

// One way to make a medium for each way to vary.
class Maker {
 public:
    Maker(const MediumDescription& d, SpectrumLibrary& library) : d_(d), library_(library) {}

    std::unique_ptr<const Medium> medium() const { return std::visit(*this, d_.volume); }
    SumMedium::Part part() const {
        SumMedium::Part part;
        part.phase = phase();
        if (std::holds_alternative<UniformVolume>(d_.volume)) {
            part.sigma_t = sigma_t(), part.sigma_s = sigma_s();
            if (has_Le()) part.emission = emission(d_.Le);
        } else {
            part.varied.reset(static_cast<const HeterogeneousMedium*>(medium().release()));
            part.unit_from_world = unit_from_world();
        }
        if (std::holds_alternative<SpectralVolume>(d_.volume)) {  // whose density is sigma_t itself
            part.max_sigma_t = part.mean_sigma_t = 1;
            return part;
        }
        for (int nm = 360; nm <= 830; ++nm) {
            const auto value = static_cast<float>(d_.scale * (d_.sigma_a(nm) + d_.sigma_s(nm)));
            part.max_sigma_t = std::max(part.max_sigma_t, value);
            part.mean_sigma_t += value / 471;
        }
        return part;
    }

    std::unique_ptr<const Medium> operator()(const UniformVolume&) const {
        return std::make_unique<HomogeneousMedium>(sigma_t(), sigma_s(), has_Le() ? emission(d_.Le) : kNone, phase());
    }
    std::unique_ptr<const Medium> operator()(const GridVolume& volume) const {
        std::uint32_t emitted = kNone;
        if (volume.temperature.grid) {
            if (d_.Le_scale > 0) emitted = emission(color::Spectrum::constant(1));
        } else if (has_Le()) {
            emitted = emission(d_.Le);
        }
        return std::make_unique<GridMedium>(phase(), medium_from_unit(), unit_from_world(), sigma_t(), sigma_s(), emitted, volume);
    }
    std::unique_ptr<const Medium> operator()(const SpectralVolume& volume) const {
        const std::uint32_t Le = add([&](double nm) { return d_.Le_scale * d_.Le(nm); });
        std::array<std::uint32_t, 3> basis{};
        for (std::size_t i = 0; i < 3; ++i) basis[i] = library_.add(color::rgb_basis()[i], Lookup::kLinear);
        return std::make_unique<SpectralGridMedium>(phase(), unit_from_world(), add([](double) { return 1; }),
                                                    static_cast<float>(d_.scale), Le, basis, volume);
    }
    std::unique_ptr<const Medium> operator()(const CloudVolume& volume) const {
        return std::make_unique<CloudMedium>(phase(), medium_from_unit(), unit_from_world(), sigma_t(), sigma_s(), volume);
    }

 private:
    PhaseFunction phase() const { return {.g = static_cast<float>(d_.g)}; }
    bool has_Le() const { return d_.Le_scale > 0 && d_.Le.max_value() > 0; }
    std::uint32_t add(const std::function<double(double)>& value) const {
        return library_.add(color::Spectrum::from_function(value, color::Outside::kZero), Lookup::kNearestNm);
    }
    std::uint32_t sigma_t() const {
        return add([&](double nm) { return d_.scale * (d_.sigma_a(nm) + d_.sigma_s(nm)); });
    }
    std::uint32_t sigma_s() const {
        return add([&](double nm) { return d_.scale * d_.sigma_s(nm); });
    }
    // What absorbs emits.
    std::uint32_t emission(const color::Spectrum& Le) const {
        return add([&](double nm) { return d_.scale * d_.sigma_a(nm) * d_.Le_scale * Le(nm); });
    }
    Affined medium_from_unit() const {
        const Vec3d size = d_.high - d_.low;
        return {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}, d_.low};
    }
    Affined unit_from_world() const { return (d_.world_from_medium * medium_from_unit()).inverse().value_or(Affined{}); }

    const MediumDescription& d_;
    SpectrumLibrary& library_;
};

// Those that a medium is the sum of, which are no sums themselves.
void find_parts(const std::vector<MediumDescription>& media, std::uint32_t i, std::vector<const MediumDescription*>& parts) {
    if (media[i].summed[0] == kNone) return parts.push_back(&media[i]);
    for (const std::uint32_t part : media[i].summed) find_parts(media, part, parts);
}

// Where all parts are the same everywhere, so is their sum.
std::unique_ptr<const Medium> make_sum(const std::vector<const MediumDescription*>& parts, SpectrumLibrary& library) {
    const auto is_uniform = [](const MediumDescription* d) { return std::holds_alternative<UniformVolume>(d->volume); };
    const auto sum_of = [&](const std::function<double(const MediumDescription&, double)>& value) {
        const auto sum = [&](double nm) {
            double total = 0;
            for (const MediumDescription* d : parts) total += value(*d, nm);
            return total;
        };
        return library.add(color::Spectrum::from_function(sum, color::Outside::kZero), Lookup::kNearestNm);
    };
    const auto sigma_s = [](const MediumDescription& d, double nm) { return d.scale * d.sigma_s(nm); };
    const auto sigma_t = [](const MediumDescription& d, double nm) { return d.scale * (d.sigma_a(nm) + d.sigma_s(nm)); };
    if (std::all_of(parts.begin(), parts.end(), is_uniform)) {
        const auto emission = [](const MediumDescription& d, double nm) { return d.scale * d.sigma_a(nm) * d.Le_scale * d.Le(nm); };
        const bool emits = std::any_of(parts.begin(), parts.end(),
                                       [](const MediumDescription* d) { return d->Le_scale > 0 && d->Le.max_value() > 0; });
        std::vector<HomogeneousMedium::Part> phases;
        for (const MediumDescription* d : parts) {
            const auto own = [&](double nm) { return sigma_s(*d, nm); };
            phases.push_back({PhaseFunction{.g = static_cast<float>(d->g)},
                              library.add(color::Spectrum::from_function(own, color::Outside::kZero), Lookup::kNearestNm)});
        }
        return std::make_unique<HomogeneousMedium>(sum_of(sigma_t), sum_of(sigma_s), emits ? sum_of(emission) : kNone,
                                                   std::move(phases));
    }
    std::vector<SumMedium::Part> made;
    for (const MediumDescription* d : parts) made.push_back(Maker(*d, library).part());
    const color::Spectrum one = color::Spectrum::from_function([](double) { return 1; }, color::Outside::kZero);
    return std::make_unique<SumMedium>(std::move(made), library.add(one, Lookup::kNearestNm));
}

}  // namespace

std::unique_ptr<const Medium> make_medium(const std::vector<MediumDescription>& media, std::uint32_t i, SpectrumLibrary& library) {
    std::vector<const MediumDescription*> parts;
    find_parts(media, i, parts);
    return parts.size() == 1 ? Maker(*parts[0], library).medium() : make_sum(parts, library);
}

}  // namespace latent::render
