// tools/merge/report.h: the final report of latent-merge.
#pragma once

#include <string>

#include "tools/merge/merge.h"

namespace latent::merge {

std::string to_text(const MergeReport& report);  // facts for people
std::string to_json(const MergeReport& report);  // the same and more, for scripts

}  // namespace latent::merge
