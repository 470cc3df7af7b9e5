// base/memory.h: how much memory this process may use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace latent {

// Bytes: the machine's memory, or less if a control group (of a container or a batch system) or a resource limit (ulimit -v) is
// lower.
std::uint64_t usable_memory();

// Bytes that a tool may take unless a number is given: 1 GiB, but at most half of what is usable, for there is more beside its
// buffers.
std::uint64_t default_memory(std::uint64_t usable = usable_memory());

// The lowest limit in bytes of the control groups that `memberships` names, and of those that contain them; the largest number if
// there is none. `memberships`: the text of /proc/self/cgroup, of version 1, 2 or both; `root`: where the groups are mounted.
// cgroups(7).
std::uint64_t control_group_limit(std::string_view memberships, const std::filesystem::path& root);

}  // namespace latent
