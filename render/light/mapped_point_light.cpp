#include "render/light/mapped_point_light.h"

namespace latent::render {
namespace {

PointSource source_at(const Vec3f& p, const EnvironmentMap&) { return {p}; }
PointSource source_at(const Vec3f& p, const ProjectionMap& map) { return {p, map.axis(), map.corner()}; }

}  // namespace

template <class Map>
MappedPointLight<Map>::MappedPointLight(const LightDescription& light, const Map& map, std::uint32_t spectrum)
    : source_(source_at(Vec3f(light.world_from_light.t), map)), map_(&map), medium_(light.medium) {
    emission_ = {spectrum, static_cast<float>(light.scale * (light.power ? *light.power / extent() : 1))};
}

template <class Map>
void MappedPointLight<Map>::sample_ray(Uniform, Uniform, Uniform s, Uniform t, LightRay& out) const {
    const Vec3f d = map_->sample(s, t);
    out = {.at = {source_.p, 0, {}}, .d = d, .pdf_position = 1, .pdf_direction = map_->pdf_omega(d), .medium = medium_};
}

template class MappedPointLight<EnvironmentMap>;
template class MappedPointLight<ProjectionMap>;

}  // namespace latent::render
