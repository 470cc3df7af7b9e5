#include "render/medium/march.h"

#include <algorithm>

namespace latent::render {

std::uint32_t medium_at_start(const Geometry& geometry, Vec3f& p, const Vec3f& d, float time, std::uint32_t given) {
    // From a little before the point to a little behind: from the point itself a ray hits a surface or not, as it rounds.
    const float reach = 0x1p-18f * geometry.radius();
    if (!(reach > 0)) return given;
    const Line line = geometry.trace({p - d * reach, d, 2 * reach, time}, Stop::kNothing);
    if (line.crossings.empty()) return given;
    p += d * reach;  // so that the line does not meet some of them once more, as it rounds
    return line.crossings.back().entered;
}

March::March(const Line& line, const Ray& ray, float length, std::uint32_t medium)
    : line_(line), o_(ray.o), metres_per_t_(render::length(ray.d)), length_(length) {
    segment_ = {ray.o, ray.d, 0, medium};
    segment_.length = end_of_segment();
}

float March::end_of_segment() const {
    if (segment_.index < line_.crossings.size()) return line_.crossings[segment_.index].t * metres_per_t_;
    return line_.hit ? line_.hit->t * metres_per_t_ : length_;
}

bool March::next() {
    if (segment_.index == line_.crossings.size()) return false;
    const Crossing& crossing = line_.crossings[segment_.index++];
    segment_.o = o_ + segment_.d * crossing.t;
    segment_.medium = crossing.entered;
    segment_.length = std::max(end_of_segment() - crossing.t * metres_per_t_, 0.0f);
    return true;
}

}  // namespace latent::render
