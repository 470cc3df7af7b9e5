#include "render/load/pbrt/transforms.h"

#include <fmt/format.h>

#include <cmath>

namespace latent::render {

namespace {

Affined translation(const Vec3d& t) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t}; }

// Rotation by `degrees` about `axis`, counterclockwise where the axis points at the viewer in right-handed coordinates.
Affined rotation(double degrees, const Vec3d& axis) {
    const Vec3d a = normalize(axis);
    const double s = std::sin(degrees * std::numbers::pi / 180), c = std::cos(degrees * std::numbers::pi / 180);
    const auto image = [&](const Vec3d& v) { return a * dot(a, v) * (1 - c) + v * c + cross(a, v) * s; };
    return {image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1}), {0, 0, 0}};
}

// Camera space from world space: z looks along, x is to the right in the image, which is what left-handed coordinates make of it.
std::optional<Affined> look_at(const Vec3d& from, const Vec3d& at, const Vec3d& up) {
    const Vec3d z = normalize(at - from), right = normalize(cross(normalize(up), z));
    if (!std::isfinite(dot(z, z)) || !std::isfinite(dot(right, right))) return std::nullopt;
    return Affined(right, cross(z, right), z, from).inverse();
}

Vec3d vec(std::span<const double> v) { return {v[0], v[1], v[2]}; }

// Multiplies by the directive. False: not a directive that does.
bool multiply(const Directive& d, Affined& ctm, Diagnostics& diagnostics) {
    const std::vector<double>& n = d.numbers;
    if (d.name == "Identity") {
        ctm = {};
    } else if (d.name == "Translate") {
        ctm = ctm * translation(vec(n));
    } else if (d.name == "Scale") {
        ctm = ctm * Affined({n[0], 0, 0}, {0, n[1], 0}, {0, 0, n[2]}, {0, 0, 0});
    } else if (d.name == "Rotate") {
        const Vec3d axis{n[1], n[2], n[3]};
        if (!(length(axis) > 0)) {
            diagnostics.error(d.where, "Rotate: the axis is 0");
        } else {
            ctm = ctm * rotation(n[0], axis);
        }
    } else if (d.name == "LookAt") {
        const std::optional<Affined> view = look_at(vec(n), vec(std::span(n).subspan(3)), vec(std::span(n).subspan(6)));
        if (view) {
            ctm = ctm * *view;
        } else {
            diagnostics.error(d.where, "LookAt: the direction is 0, or parallel to up");
        }
    } else if (d.name == "Transform" || d.name == "ConcatTransform") {
        // The file holds columns: the images of x, y, z and the origin, each with its w.
        const Affined map(vec(n), vec(std::span(n).subspan(4)), vec(std::span(n).subspan(8)), vec(std::span(n).subspan(12)));
        if (n[3] != 0 || n[7] != 0 || n[11] != 0 || n[15] != 1)
            diagnostics.error(d.where, d.name + ": projective transformations are not supported");
        ctm = d.name == "Transform" ? map : ctm * map;
    } else {
        return false;
    }
    return true;
}

}  // namespace

bool Transforms::apply(const Directive& d, CurrentTransform& ctm, Diagnostics& diagnostics) {
    if (apply_to_both(d, ctm, diagnostics)) return true;
    const bool as_one = ctm.start_active && ctm.end_active && !ctm.moves();
    if (as_one) {  // so that one message is given, not two
        if (!multiply(d, ctm.start, diagnostics)) return false;
        ctm.end = ctm.start;
        return true;
    }
    const bool at_start = ctm.start_active && multiply(d, ctm.start, diagnostics);
    return (ctm.end_active && multiply(d, ctm.end, diagnostics)) || at_start;
}

bool Transforms::apply_to_both(const Directive& d, CurrentTransform& ctm, Diagnostics& diagnostics) {
    if (d.name == "CoordinateSystem") {
        named_[d.strings[0]] = ctm;
    } else if (d.name == "CoordSysTransform") {
        const auto found = named_.find(d.strings[0]);
        if (found == named_.end()) {
            undefined_.push_back(
                {d.where, fmt::format("coordinate system \"{}\"", d.strings[0]), "; it must be defined before it is used"});
        } else {
            ctm.start = found->second.start;
            ctm.end = found->second.end;
        }
    } else if (d.name == "ActiveTransform") {
        const std::string& which = d.strings[0];
        if (which != "StartTime" && which != "EndTime" && which != "All")
            diagnostics.error(d.where, fmt::format("ActiveTransform: {} is neither StartTime, EndTime nor All", which));
        ctm.start_active = which != "EndTime";
        ctm.end_active = which != "StartTime";
    } else {
        return false;
    }
    return true;
}

}  // namespace latent::render
