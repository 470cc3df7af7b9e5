// tools/merge/report.h: what latent-merge says when it is done.
#pragma once

#include <string>

#include "tools/merge/merge.h"

namespace latent::merge {

std::string to_text(const MergeReport& report);  // facts for people
std::string to_json(const MergeReport& report);  // the same and more, for scripts

}  // namespace latent::merge
