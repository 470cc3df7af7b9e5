#include "render/transport/transport.h"

namespace latent::render {

Transport::Transport(std::unique_ptr<World> world, const IntegratorSettings& settings)
    : world_(std::move(world)),
      settings_(settings),
      density_(wavelength_density(world_->lights().spectra())),
      wavelengths_(density_, settings.batch),
      sampler_(settings.seed, important_dimensions(*world_), shared_dimensions()),
      records_(settings.record, settings.light_groups.any()),
      spectra_([this] { return SampledSpectra(world_->library()); }) {}

void Transport::trace(std::uint64_t n, sampledb::Records& out, RadianceFaults& faults) const {
    SampledSpectra& spectra = spectra_.local();
    const SampleNumbers numbers(sampler_, n);
    wavelengths_.draw(numbers(Dimension::kXi).fraction32(), spectra.wavelengths);
    spectra.start_sample();
    const std::uint32_t kept = numbers(Dimension::kKeptWavelength).index(spectra.wavelengths.k);
    SampleState sample{numbers, spectra, kept};

    const sampledb::FilmPosition film = sampledb::halton23(n, settings_.positions);
    Radiance camera(settings_.light_groups);
    trace_paths(sample, film.u * 0x1p-32, film.v * 0x1p-32, camera, out, faults);
    records_.camera(n, film.u, film.v, camera, spectra.wavelengths, kept, out, faults);
}

std::vector<Sampler::Sharing> shared_dimensions() {
    using D = Dimension;
    const auto vertex = [](std::uint32_t v, std::uint32_t what) { return D::of_camera_vertex(v, what); };
    return {{D::kStartDirectionU, vertex(0, D::kLightU)},
            {D::kStartDirectionV, vertex(0, D::kLightV)},
            {D::kStartU, vertex(1, D::kLightU)},
            {D::kStartV, vertex(1, D::kLightV)},
            {D::kStartLight, vertex(0, D::kLight)}};
}

std::vector<std::uint32_t> important_dimensions(const World& world) {
    using D = Dimension;
    std::vector<std::uint32_t> list;
    const auto vertex = [&](std::uint32_t v, std::initializer_list<std::uint32_t> what) {
        for (const std::uint32_t w : what) list.push_back(D::of_camera_vertex(v, w));
    };
    if (world.camera().has_lens()) {
        list.push_back(D::kLensU);
        list.push_back(D::kLensV);
    }
    if (world.has_media()) vertex(0, {D::kDistance});
    vertex(0, {D::kLightU, D::kLightV, D::kDirectionU, D::kDirectionV});
    if (world.lights().size() > 1) vertex(0, {D::kLight});
    list.push_back(D::kXi);
    if (world.has_dispersion()) list.push_back(D::kKeptWavelength);
    vertex(0, {D::kLobe});
    if (world.has_media()) vertex(1, {D::kDistance});
    vertex(1, {D::kLightU, D::kLightV, D::kDirectionU, D::kDirectionV, D::kLobe, D::kLight, D::kSurvival});
    if (world.has_media()) vertex(0, {D::kEquiangular});
    return list;
}

}  // namespace latent::render
