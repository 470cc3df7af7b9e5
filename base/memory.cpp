#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace latent {

namespace {

// The number of bytes that a file holds. Any other text ("max") is no limit.
std::uint64_t limit_in(const std::filesystem::path& file) {
    std::uint64_t bytes = 0;
    return std::ifstream(file) >> bytes ? bytes : std::numeric_limits<std::uint64_t>::max();
}

}  // namespace

std::uint64_t control_group_limit(std::string_view memberships, const std::filesystem::path& root) {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::istringstream lines{std::string(memberships)};
    for (std::string id, controllers, group;
         std::getline(lines, id, ':') && std::getline(lines, controllers, ':') && std::getline(lines, group);) {
        const bool is_version_2 = controllers.empty();
        if (!is_version_2 && ("," + controllers + ",").find(",memory,") == std::string::npos) continue;
        const std::filesystem::path top = is_version_2 ? root : root / "memory";
        std::filesystem::path path = std::filesystem::path(group).relative_path();
        while (true) {
            least = std::min(least, limit_in(top / path / (is_version_2 ? "memory.max" : "memory.limit_in_bytes")));
            if (path.empty()) break;
            path = path.parent_path();
        }
    }
    return least;
}

std::uint64_t usable_memory() {
    const std::uint64_t physical =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    std::ostringstream memberships;
    memberships << std::ifstream("/proc/self/cgroup").rdbuf();
    struct rlimit address_space {};
    const bool is_limited = ::getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY;
    const std::uint64_t limit = is_limited ? address_space.rlim_cur : std::numeric_limits<std::uint64_t>::max();
    return std::min({physical, limit, control_group_limit(memberships.str(), "/sys/fs/cgroup")});
}

std::uint64_t default_memory(std::uint64_t usable) { return std::min(std::uint64_t{1} << 30, usable / 2); }

}  // namespace latent
