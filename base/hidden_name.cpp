#include "base/hidden_name.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <vector>

#include "base/file.h"
#include "base/hash.h"

namespace latent {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kSuffix = ".tmp";
constexpr std::size_t kNonceDigits = 16;

constexpr std::size_t kMaxNameBytes = 255;  // NAME_MAX, of every file system that Linux writes to

// A hash stands for a name so long that nothing can be added to it.
std::string prefix_of(const fs::path& path) {
    const std::string name = path.filename().string();
    const bool fits = name.size() + 2 + kNonceDigits + kSuffix.size() <= kMaxNameBytes;
    return fmt::format(".{}.", fits ? name : to_hex(hash128(std::as_bytes(std::span(name)))));
}

bool is_hidden_name(std::string_view name, std::string_view prefix) {
    if (name.size() != prefix.size() + kNonceDigits + kSuffix.size() || !name.starts_with(prefix) || !name.ends_with(kSuffix))
        return false;
    return name.substr(prefix.size(), kNonceDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

// 0, or why not.
int try_lock(int fd) {
    while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno != EINTR) return errno;
    }
    return 0;
}

}  // namespace

fs::path hidden_name(const fs::path& path) {
    return folder_of(path) / fmt::format("{}{}{}", prefix_of(path), make_nonce(), kSuffix);
}

bool is_named(int fd, const fs::path& path) {
    struct stat open, named;
    return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
           open.st_ino == named.st_ino;
}

bool lock_hidden(int fd) { return try_lock(fd) != EWOULDBLOCK; }

void remove_abandoned(const fs::path& path) {
    std::vector<fs::path> found;
    std::error_code failed;
    for (fs::directory_iterator it(folder_of(path), failed); !failed && it != fs::directory_iterator(); it.increment(failed)) {
        if (is_hidden_name(it->path().filename().string(), prefix_of(path))) found.push_back(it->path());
    }
    std::ranges::sort(found);
    for (const fs::path& hidden : found) {
        constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
        int fd = ::open(hidden.c_str(), O_RDWR | kFlags);  // NFS locks nothing else
        if (fd < 0 && errno == EISDIR) fd = ::open(hidden.c_str(), O_RDONLY | kFlags);
        if (fd < 0) continue;
        if (try_lock(fd) == 0 && is_named(fd, hidden)) fs::remove_all(hidden, failed);
        ::close(fd);
    }
}

}  // namespace latent
