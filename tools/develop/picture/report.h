// tools/develop/picture/report.h: the final report of latent-develop.
#pragma once

#include <string>
#include <vector>

#include "tools/develop/picture/picture.h"

namespace latent::develop {

std::string to_text(const PictureReport& report);              // facts for people
std::string to_json(const PictureReport& report);              // the same and more, for scripts
std::vector<std::string> losses(const PictureReport& report);  // one line for each thing that was left out

}  // namespace latent::develop
