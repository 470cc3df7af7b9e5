// render/texture/footprint.h: how much of a surface a point of it stands for. docs/rendering.md, "Textures".
#pragma once

#include <cstdint>

#include "render/math/vec.h"
#include "render/scene/description.h"

namespace latent::render {

// A share of what one pixel of the camera sees, were the point seen directly: of the same size whichever path has come there, and
// never larger than what a camera ray stands for. Of a camera that moves: from its nearest place.
class Footprint {
 public:
    // A film of `width` x `height` pixels.
    Footprint(const CameraDescription& camera, std::uint32_t width, std::uint32_t height);

    // The axes of an ellipse about p on the surface with unit normal n.
    void at(const Vec3f& p, const Vec3f& n, Vec3f& dpdx, Vec3f& dpdy) const;

 private:
    Vec3f center_, axis_;
    Vec3f way_{};  // that the centre moves along
    bool parallel_, turns_ = false;
    float size_;        // size of a pixel on the axis: an angle, or for parallel rays a length
    float min_cosine_;  // to the axis, of what the film shows; 1: pixels are as large everywhere
};

}  // namespace latent::render
