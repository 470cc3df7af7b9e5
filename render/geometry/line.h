// render/geometry/line.h: the media along a line of sight, from the surfaces that it hits.
#pragma once

#include "render/geometry/geometry.h"

namespace latent::render {

// Adds what `surfaces` say of media to a line along d: those before its hit as crossings, those at it as the hit's own media.
// `surfaces`: every surface between two media up to a little behind the hit, its own included; each once, in order of t.
void add_media(std::vector<SurfaceHit> surfaces, const Vec3f& d, Line& line);

}  // namespace latent::render
