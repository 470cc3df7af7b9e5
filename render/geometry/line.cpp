#include "render/geometry/line.h"

#include <algorithm>
#include <span>

namespace latent::render {

namespace {

// The media on both sides of one surface, for a line along d.
Crossing crossing_of(const SurfaceHit& s, const Vec3f& d) {
    return leads_out(s, d) ? Crossing{s.t, s.inside_medium, s.outside_medium} : Crossing{s.t, s.outside_medium, s.inside_medium};
}

// Surfaces that lie on one another, as one. Each begins in the medium behind the one before, whatever their order here, so the
// media between them cancel. None: together they do not change the medium.
std::optional<Crossing> crossing_of(std::span<const SurfaceHit> surfaces, const Vec3f& d) {
    if (surfaces.size() == 1) return crossing_of(surfaces.front(), d);
    std::vector<std::uint32_t> left, entered;
    const auto count = [](std::uint32_t medium, std::vector<std::uint32_t>& side, std::vector<std::uint32_t>& opposite) {
        const auto same = std::ranges::find(opposite, medium);
        if (same == opposite.end())
            side.push_back(medium);
        else
            opposite.erase(same);
    };
    for (const SurfaceHit& s : surfaces) {
        const Crossing one = crossing_of(s, d);
        count(one.left, left, entered);
        count(one.entered, entered, left);
    }
    if (entered.empty()) return std::nullopt;
    return Crossing{surfaces.front().t, left.front(), entered.back()};
}

void set_media(std::span<const SurfaceHit> surfaces, const Vec3f& d, SurfaceHit& hit) {
    const Crossing all = crossing_of(surfaces, d).value_or(Crossing{hit.t, kNone, kNone});
    const bool out = leads_out(hit, d);
    hit.inside_medium = out ? all.left : all.entered;
    hit.outside_medium = out ? all.entered : all.left;
    // Rays that leave the hit also leave the interfaces that lie on it.
    for (const SurfaceHit& s : surfaces) {
        if (is_interface(s.material)) hit.error = std::max(hit.error, s.error + std::abs(dot(s.ng, hit.p - s.p)));
    }
}

}  // namespace

std::optional<std::uint32_t> Line::medium_before(const Vec3f& d) const {
    if (!crossings.empty()) return crossings.front().left;
    if (!hit || hit->inside_medium == hit->outside_medium) return std::nullopt;
    return crossing_of(*hit, d).left;
}

void add_media(std::vector<SurfaceHit> surfaces, const Vec3f& d, Line& line) {
    std::span<const SurfaceHit> rest = surfaces;
    if (line.hit) {
        const auto is_before = [&](const SurfaceHit& s) { return !contains(*line.hit, s.interaction()); };
        const auto at_hit = std::stable_partition(surfaces.begin(), surfaces.end(), is_before);
        rest = {surfaces.begin(), at_hit};
        if (at_hit != surfaces.end()) set_media({at_hit, surfaces.end()}, d, *line.hit);
    }
    while (!rest.empty() && !(line.hit && rest.front().t > line.hit->t)) {
        std::size_t count = 1;
        while (count < rest.size() && contains(rest.front(), rest[count].interaction())) ++count;
        if (const std::optional<Crossing> crossing = crossing_of(rest.first(count), d)) line.crossings.push_back(*crossing);
        rest = rest.subspan(count);
    }
}

}  // namespace latent::render
