// render/scene/check.h: what a description may say and this renderer refuses, whichever format it came from.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "render/scene/description.h"

namespace latent::render {

// Each of these: all reasons why not, a sentence each; empty if there is none.
using Refusals = std::vector<std::string>;

// Whether a map is a rotation, mirroring and uniform scale, to `tolerance` of that scale, and a translation.
bool is_even(const Affined& map, double tolerance);
// A transformation that skews or stretches; a lens on another camera than a perspective one.
Refusals check_camera(const CameraDescription& camera);
// An area light on a shape of which no points can be drawn: on curved patches, and on quadrics but disks that are stretched.
Refusals check_area_light(const ShapeDescription& shape);
// Whether a quadric is not placed by a rotation, translation, mirroring and uniform scale alone.
bool is_stretched(const ShapeDescription& quadric);
// Textures that are made of themselves, of others more than 256 deep, or of more than 10,000: index and reason.
std::vector<std::pair<std::uint32_t, std::string>> check_textures(const std::vector<TextureDescription>& textures);
// Mixtures that are made of themselves, more than 256 deep, or of more than 10,000 materials.
std::vector<std::uint32_t> endless_mixtures(const std::vector<MaterialDescription>& materials);
// Media that are sums of themselves, or of more than kMaxSummed.
std::vector<std::uint32_t> sums_of_too_many(const std::vector<MediumDescription>& media);

}  // namespace latent::render
