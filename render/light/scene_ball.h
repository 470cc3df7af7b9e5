// render/light/scene_ball.h: the ball that holds the scene, the camera and the outermost medium: infinite lights shine on it
// through disks outside of it.
#pragma once

#include "render/light/light_type.h"

namespace latent::render {

struct SceneBall {
    Vec3f center;
    float radius;

    double disk_area() const { return std::numbers::pi * static_cast<double>(radius) * static_cast<double>(radius); }
    float pdf_position() const { return 1 / (kPi * radius * radius); }  // 1/m^2 on the disk
    // A ray that comes from unit `towards`, through an even point of the disk across that.
    LightRay sample_ray(const Vec3f& towards, float pdf_direction, Uniform u, Uniform v) const {
        const Vec2f d = sample_disk(u, v);
        const Frame frame = Frame::from_z(towards);
        return {.at = {center + (frame.x * d.x + frame.y * d.y + towards) * radius, 0, {}},
                .d = -towards,
                .pdf_position = pdf_position(),
                .pdf_direction = pdf_direction};
    }
};

}  // namespace latent::render
