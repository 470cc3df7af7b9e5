// render/load/foreign_format.h: what a file is that was given as a scene and is none.
#pragma once

#include <string_view>

namespace latent::render {

// "this is a glTF scene", of text in which no directive could be read; empty if nothing is recognised.
std::string_view foreign_format(std::string_view text);

}  // namespace latent::render
