#include "render/medium/make_medium.h"

#include "render/medium/grid.h"
#include "render/medium/homogeneous.h"

namespace latent::render {

std::unique_ptr<const Medium> make_medium(const MediumDescription& d, SpectrumLibrary& library) {
    const auto add = [&](const std::function<double(double)>& sigma) {
        return library.add(color::Spectrum::from_function(sigma, color::Outside::kZero), Lookup::kNearestNm);
    };
    const PhaseFunction phase{.g = static_cast<float>(d.g)};
    const std::uint32_t sigma_t = add([&](double nm) { return d.scale * (d.sigma_a(nm) + d.sigma_s(nm)); });
    const std::uint32_t sigma_s = add([&](double nm) { return d.scale * d.sigma_s(nm); });
    const Vec3d size = d.high - d.low;
    const Affined medium_from_unit({size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}, d.low);
    const Affined unit_from_world = (d.world_from_medium * medium_from_unit).inverse().value_or(Affined{});

    struct Make {
        std::unique_ptr<const Medium> operator()(const UniformVolume&) const {
            return std::make_unique<HomogeneousMedium>(sigma_t, sigma_s, phase);
        }
        std::unique_ptr<const Medium> operator()(const GridVolume& volume) const {
            return std::make_unique<GridMedium>(phase, medium_from_unit, unit_from_world, sigma_t, sigma_s, volume);
        }
        const PhaseFunction& phase;
        std::uint32_t sigma_t, sigma_s;
        const Affined &medium_from_unit, &unit_from_world;
    };
    return std::visit(Make{phase, sigma_t, sigma_s, medium_from_unit, unit_from_world}, d.volume);
}

}  // namespace latent::render
