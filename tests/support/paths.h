// tests/support/paths.h: where the tests find the source tree and the built tools.
#pragma once

#include <string>

namespace latent::testing {

// A file or folder, named from the root of the source tree.
std::string in_tree(const std::string& name);

// The built executable of that name ("latent-merge").
std::string tool(const std::string& name);

// The folder of all built executables.
std::string tools_folder();

}  // namespace latent::testing
