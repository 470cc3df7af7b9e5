#include "base/output_name.h"

namespace latent {

std::string objection_to_output(const std::filesystem::path& output) {
    if (output.empty()) return "the name is empty";
    if (output != "-" && !output.string().starts_with("/dev/")) return "";
    return output.string() + ": outputs are files, which get their names once they are complete; write one, then use cat";
}

}  // namespace latent
