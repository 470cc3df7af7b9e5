// render/load/model/options.h: what a model cannot say itself, and who renders it says instead. docs/models.md.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace latent::render {

// From where a model without a camera is seen: its front is +z.
enum class ModelView : std::uint8_t { kThreeQuarter, kFront, kTop };

struct ModelOptions {
    std::string camera{};                            // the name of a camera or of its node, or its number from 1; empty: the first
    std::string variant{};                           // the name of a variant of the model's materials; empty: as they are
    std::string animation{};                         // the name of an animation, or its number from 1; empty: the first
    std::optional<double> time{};                    // [s] of the animation; nothing: the model rests, unless `animation` is said
    std::optional<std::array<double, 2>> shutter{};  // opens and closes so many seconds after that; nothing: at once
    ModelView view = ModelView::kThreeQuarter;
    bool is_z_up = false;               // for models without a camera: up is +z, and the front -y; else up is +y, and the front +z
    bool stage = true;                  // a model without camera and lights stands on a ground
    std::optional<double> aspect{};     // width over height of the picture of a model without a camera; nothing: 16:9
    double lens_radius = 0, focus = 0;  // the camera's, in the model's units; 0: not said
    std::filesystem::path sky{};        // a picture of the sky; empty: none

    bool operator==(const ModelOptions&) const = default;
};

}  // namespace latent::render
