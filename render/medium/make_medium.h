// render/medium/make_medium.h: media as scenes describe them, ready to be tracked.
#pragma once

#include <memory>

#include "render/medium/medium.h"
#include "render/scene/description.h"

namespace latent::render {

// Medium i. Its spectra join the library.
std::unique_ptr<const Medium> make_medium(const std::vector<MediumDescription>& media, std::uint32_t i, SpectrumLibrary& library);

}  // namespace latent::render
