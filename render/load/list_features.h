// render/load/list_features.h: everything that scene files may say, as text.
#pragma once

#include <string>

namespace latent::render {

std::string list_features();

}  // namespace latent::render
