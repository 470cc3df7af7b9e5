// base/naming_journal.h: which files and folders are about to get which names; what OutputSet goes by when its process was killed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace latent {

// Tells a file or folder from all others that ever have its name: the number of an inode is given again, but not at the same time.
struct Identity {
    std::uint64_t inode = 0, seconds = 0, nanoseconds = 0;  // of its birth; else of its last change
    bool operator==(const Identity&) const = default;
};
// Of what `path` itself names, be it a symbolic link. None if there is nothing; errno says why.
std::optional<Identity> identity_of(const std::filesystem::path& path);

struct NamingEntry {
    Identity identity;
    std::string name;  // without its folder
};
using NamingJournal = std::vector<NamingEntry>;

// Kept in the folder `hidden`: there wholly or not at all, and then read as empty.
Status write_naming_journal(const std::filesystem::path& hidden, const NamingJournal& journal);
NamingJournal read_naming_journal(const std::filesystem::path& hidden);

}  // namespace latent
