// base/near_names.h: names as people misspell them.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace latent {

// Without case, blanks, '-' and '_', which people mix up: "Canon EOS-5D" and "canon_eos_5d" are the same name.
std::string folded_name(std::string_view name);

// Those of `names` that are near to `name`, nearest first, at most five: "canon_eos_5d, canon_eos_5ds". A name is near if it
// contains the other one, or leaves out letters of it, or if few letters must change, come, go or change places. Empty if there is
// none.
std::string near_names(std::string_view name, std::span<const std::string> names);

}  // namespace latent
