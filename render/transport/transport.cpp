#include "render/transport/transport.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/sampling/halton_sampler.h"
#include "render/sampling/pixel_sampler.h"

namespace latent::render {

Transport::Transport(std::unique_ptr<World> world, const IntegratorSettings& settings)
    : world_(std::move(world)),
      settings_(settings),
      density_(wavelength_density(world_->lights().spectra())),
      wavelengths_(density_, settings.batch),
      sampler_(make_sampler(settings.positions, settings.seed, *world_)),
      records_(settings.record, settings_.light_groups, settings.aovs),
      aovs_(*world_, settings.aovs, settings.max_depth),
      of_thread_([this] { return OfThread{SampledSpectra(world_->library())}; }) {}

void Transport::trace(std::uint64_t n, sampledb::Records& out, RadianceFaults& faults) const {
    OfThread& of_thread = of_thread_.local();
    SampledSpectra& spectra = of_thread.spectra;
    const SampleNumbers numbers(*sampler_, n);
    wavelengths_.draw(numbers(Dimension::kXi).fraction32(), spectra.wavelengths);
    spectra.start_sample();
    const std::uint32_t kept = numbers(Dimension::kKeptWavelength).index(spectra.wavelengths.k);
    SampleState state{numbers, spectra, kept};
    state.time = world_->time(world_->moves() ? numbers(Dimension::kTime) : Uniform{});
    const std::optional<Camera> moved = world_->camera_at(state.time);
    const Camera& camera = moved ? *moved : world_->camera();
    SampleRecords records(records_, state, camera, {out, faults});
    const TracedSample sample{state, camera, records};

    const sampledb::FilmPosition at = numbers.position();
    const Vec2d film{at.u * 0x1p-32, at.v * 0x1p-32};
    if (camera.splits_wavelengths()) {
        trace_split(sample, film);
    } else {
        Radiance seen(settings_.light_groups, state);
        trace_paths(sample, film, false, seen);
        records.camera(at.u, at.v, seen, look(sample, film));
    }
    of_thread.shadow_rays += state.shadow_rays;
}

std::uint64_t Transport::shadow_rays() const {
    std::uint64_t sum = 0;
    for (const OfThread& of_thread : of_thread_) sum += of_thread.shadow_rays;
    return sum;
}

Seen Transport::look(const TracedSample& sample, Vec2d film) const {
    return settings_.aovs.any() ? aovs_.look(sample.state, sample.camera, film.x, film.y) : Seen{};
}

// The film points of all wavelengths are spread evenly over the film: one that lies beyond an edge comes back over the opposite
// edge. A ray belongs to those that go round equally often, so a sample near an edge has several.
void Transport::trace_split(const TracedSample& sample, Vec2d film) const {
    const Camera& camera = sample.camera;
    const Wavelengths& w = sample.state.spectra.wavelengths;
    const Vec2f spread = camera.spread(camera.lens_point(sample.state.numbers));
    struct Place {
        Vec2d at, rounds;
        bool operator==(const Place& b) const { return rounds.x == b.rounds.x && rounds.y == b.rounds.y; }
    };
    const auto place_of = [&](std::uint32_t i) {
        const double defocus = camera.defocus(static_cast<double>(w.lambda_nm[i]));
        const Vec2d at{film.x + static_cast<double>(spread.x) * defocus, film.y + static_cast<double>(spread.y) * defocus};
        return Place{at, {std::floor(at.x), std::floor(at.y)}};
    };
    std::array<bool, kMaxWavelengths> recorded{};
    bool again = false;
    for (std::uint32_t i = 0; i < w.k; ++i) {
        if (recorded[i]) continue;
        const Place ray = place_of(i);
        const Vec2d ray_film{film.x - ray.rounds.x, film.y - ray.rounds.y};
        Radiance radiance(settings_.light_groups, sample.state);
        trace_paths(sample, ray_film, again, radiance);
        const Seen seen = look(sample, ray_film);
        again = true;
        for (std::uint32_t j = i; j < w.k; ++j) {
            const Place place = place_of(j);
            if (!(place == ray)) continue;
            const auto fixed = [](double x) { return static_cast<std::uint32_t>(std::min(x * 0x1p32, 0x1p32 - 1)); };
            sample.records.camera(fixed(place.at.x - place.rounds.x), fixed(place.at.y - place.rounds.y), radiance, seen, j);
            recorded[j] = true;
        }
    }
}

namespace {

// The ray that a light subpath starts with, by the primes of points of lights that camera vertices draw: no path has both. What
// most lights have is spread out best: directions.
std::vector<HaltonSampler::Sharing> shared_dimensions() {
    using D = Dimension;
    const auto vertex = [](std::uint32_t v, std::uint32_t what) { return D::of_camera_vertex(v, what); };
    return {{D::kStartDirectionU, vertex(0, D::kLightU)},
            {D::kStartDirectionV, vertex(0, D::kLightV)},
            {D::kStartU, vertex(1, D::kLightU)},
            {D::kStartV, vertex(1, D::kLightV)}};
}

// The dimensions of one sample in the order in which they should be well spread, for the camera subpath of this world.
std::vector<std::uint32_t> important_dimensions(const World& world) {
    using D = Dimension;
    std::vector<std::uint32_t> list;
    const auto vertex = [&](std::uint32_t v, std::initializer_list<std::uint32_t> what) {
        for (const std::uint32_t w : what) list.push_back(D::of_camera_vertex(v, w));
    };
    if (world.moves()) list.push_back(D::kTime);
    if (world.camera().has_lens()) {
        list.push_back(D::kLensU);
        list.push_back(D::kLensV);
    }
    if (world.has_media()) vertex(0, {D::kDistance});
    vertex(0, {D::kLightU, D::kLightV, D::kDirectionU, D::kDirectionV});
    list.push_back(D::kXi);
    if (world.has_dispersion()) list.push_back(D::kKeptWavelength);
    vertex(0, {D::kLobe});
    if (world.has_media()) vertex(1, {D::kDistance});
    vertex(1, {D::kLightU, D::kLightV, D::kDirectionU, D::kDirectionV, D::kLobe, D::kSurvival});
    if (world.has_media()) vertex(0, {D::kEquiangular});
    return list;
}

}  // namespace

std::unique_ptr<const Sampler> make_sampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed,
                                            const World& world) {
    if (positions.sampler == sampledb::PositionSampler::kPixels) return std::make_unique<PixelSampler>(positions, seed);
    return std::make_unique<HaltonSampler>(positions, seed, important_dimensions(world), shared_dimensions());
}

}  // namespace latent::render
