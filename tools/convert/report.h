// tools/convert/report.h: the report on a print, for people and for scripts.
#pragma once

#include <string>

#include "tools/convert/options.h"

namespace latent::convert {

std::string to_text(const ConvertReport& report);  // lines "name  value"
std::string to_json(const ConvertReport& report);  // one object

}  // namespace latent::convert
