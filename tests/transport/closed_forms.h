// tests/transport/closed_forms.h: scenes whose picture is known exactly, at any size: what asks the most of single precision.
#pragma once

#include <cstdint>
#include <string>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

struct ClosedForm {
    std::string name;
    Scene scene;
    double y;  // mean of Y over the picture
    IntegratorSettings settings{.max_depth = 1};
};

// A grey floor under a square lamp of `triangles` / 2 triangles; as many, each of 200 times the area, shine away from it.
ClosedForm lamp_among_large_triangles(std::uint32_t triangles);

}  // namespace latent::render::testing
