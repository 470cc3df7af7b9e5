// tools/convert/report.h: the report on a print, for people and for scripts.
#pragma once

#include <string>
#include <vector>

#include "tools/convert/options.h"

namespace latent::convert {

std::string to_text(const ConvertReport& report);              // lines "name  value"
std::string to_json(const ConvertReport& report);              // one object
std::vector<std::string> losses(const ConvertReport& report);  // one line for each thing that was lost

}  // namespace latent::convert
