// base/output_name.h: which names an output can have.
#pragma once

#include <filesystem>
#include <string>

namespace latent {

// Why nothing can be written to `output`: it has no name, or is standard output or another device. Empty if it can be.
std::string objection_to_output(const std::filesystem::path& output);

}  // namespace latent
