// tests/transport/closed_forms.h: scenes whose picture is known exactly, at any size: what asks the most of single precision.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

struct ClosedForm {
    std::string name;
    Scene scene;
    double y;                       // mean of Y over the picture
    std::optional<double> whole{};  // what a difference is a share of, if not of y
    IntegratorSettings settings{.max_depth = 1};
};

// A grey floor under a square lamp of `triangles` / 2 triangles; as many, each of 200 times the area, shine away from it. All of it
// stands `distance` along each axis.
ClosedForm lamp_among_large_triangles(std::uint32_t triangles, double distance = 0);

// A lamp above an opaque lid twice its size, `gap` apart, 10 m above the floor: nothing gets past the lid.
ClosedForm lamp_behind_lid(double gap);

// A small lamp `distance` away, parallel to the floor, in a direction of this cosine to the normals of both.
ClosedForm lamp_far_away(double distance, double cosine);

// The pool of light on the floor under a spot 10 m above, whole.
ClosedForm narrow_spot(double cone_degrees);

// The beam of such a spot in thin fog, seen from the side.
ClosedForm narrow_beam(double cone_degrees);

// A floor under an infinite light of size x size pixels of which one shines, after `rotation`, a directive.
ClosedForm infinite_light_of_one_pixel(std::uint32_t size, std::uint32_t x, std::uint32_t y, const std::string& rotation);

}  // namespace latent::render::testing
