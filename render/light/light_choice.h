// render/light/light_choice.h: how a light is chosen for a point that is to be lit.
#pragma once

#include <cstdint>

namespace latent::render {

// By what may come from each light to there, or by its power, as for anywhere.
enum class LightChoice : std::uint8_t { kByPlace, kByPower };

// A light that was chosen, and with which probability; 0: none can shine there.
struct ChosenLight {
    std::uint32_t light = 0;
    float probability = 0;
};

}  // namespace latent::render
