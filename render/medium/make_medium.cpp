#include "render/medium/make_medium.h"

#include "render/medium/cloud.h"
#include "render/medium/grid.h"
#include "render/medium/homogeneous.h"
#include "render/medium/spectral_grid.h"

namespace latent::render {

namespace {

// One way to make a medium for each way to vary.
class Maker {
 public:
    Maker(const MediumDescription& d, SpectrumLibrary& library) : d_(d), library_(library) {}

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
        return std::make_unique<SpectralGridMedium>(phase(), unit_from_world(), add([](double) { return 1; }),
                                                    static_cast<float>(d_.scale), Le, volume);
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

}  // namespace

std::unique_ptr<const Medium> make_medium(const MediumDescription& description, SpectrumLibrary& library) {
    return std::visit(Maker(description, library), description.volume);
}

}  // namespace latent::render
