// tests/faults/fault_shim.cpp: a library for LD_PRELOAD that makes chosen system calls of a program fail, as a disk would.
//
//   LATENT_FAULT=CALL:N:WHAT[,...]   CALL  write (write, pwrite), read (read, pread), sync (fsync, fdatasync), mkdir,
//                                          unlink (unlink, unlinkat), copy (copy_file_range), link (link, linkat, rename,
//                                          renameat2), renameat2 (that alone), create (open with O_CREAT or O_TMPFILE), lock
//                                          (flock)
//                                    N     the N-th such call, counted from 1; "N+" that one and all later ones
//                                    WHAT  EIO, ENOSPC, EDQUOT, EINTR, EXDEV, EROFS, EACCES, EMFILE, EINVAL, ENOLCK, EPERM: fail
//                                    so;
//                                          short: transfer half of the bytes (1 at least); zero: return 0, nothing transferred;
//                                          flip: transfer all, but with a bit of the middle byte flipped;
//                                          kill, kill-after: SIGKILL before or after the call;
//                                          term: SIGTERM and a second to die of it, then the call;
//                                          slow: nothing wrong, but 0.2 s later
//   LATENT_FAULT_PATH=TEXT           only calls on files whose path contains TEXT (files without a name: their folder's path)
//   LATENT_FAULT_HIT=FILE            created when a fault happens, so that a test can count N up until nothing happens any more
//
// Only regular files are touched: never terminals, pipes, or /proc and /sys.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

struct Rule {
    std::string call;
    long nth = 0;
    bool and_later = false;
    std::string what;
    std::atomic<long> seen{0};
    Rule(std::string c, long n, bool l, std::string w) : call(std::move(c)), nth(n), and_later(l), what(std::move(w)) {}
    Rule(Rule&& other) noexcept
        : call(std::move(other.call)), nth(other.nth), and_later(other.and_later), what(std::move(other.what)) {}
};

std::vector<Rule> parse_rules() {
    std::vector<Rule> rules;
    const char* text = std::getenv("LATENT_FAULT");
    std::string rest = text ? text : "";
    while (!rest.empty()) {
        const std::string one = rest.substr(0, rest.find(','));
        rest.erase(0, one.size() + 1);
        const std::size_t first = one.find(':'), second = one.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string nth = one.substr(first + 1, second - first - 1);
        rules.emplace_back(one.substr(0, first), std::atol(nth.c_str()), nth.back() == '+', one.substr(second + 1));
    }
    return rules;
}

std::vector<Rule>& rules() {
    static std::vector<Rule> all = parse_rules();
    return all;
}

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool chosen(const std::string& path) {
    if (path.empty() || path[0] != '/' || path.rfind("/proc/", 0) == 0 || path.rfind("/sys/", 0) == 0 ||
        path.rfind("/dev/", 0) == 0) {
        return false;
    }
    const char* wanted = std::getenv("LATENT_FAULT_PATH");
    return !wanted || path.find(wanted) != std::string::npos;
}

std::string path_of(int fd) {
    char link[64], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = ::readlink(link, path, sizeof path);
    return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : std::string();
}

std::string absolute(const char* path) {
    char folder[4096];
    if (path[0] == '/' || !::getcwd(folder, sizeof folder)) return path;
    return std::string(folder) + "/" + path;
}

void mark_hit() {
    if (const char* file = std::getenv("LATENT_FAULT_HIT")) {
        const int fd = next<int(const char*, int, ...)>("open")(file, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        if (fd >= 0) ::close(fd);
    }
}

int errno_named(const std::string& name) {
    static const struct {
        const char* name;
        int value;
    } kTable[] = {{"EIO", EIO},       {"ENOSPC", ENOSPC}, {"EDQUOT", EDQUOT}, {"EINTR", EINTR},
                  {"EXDEV", EXDEV},   {"EROFS", EROFS},   {"EACCES", EACCES}, {"EMFILE", EMFILE},
                  {"EINVAL", EINVAL}, {"ENOLCK", ENOLCK}, {"EPERM", EPERM}};
    for (const auto& entry : kTable) {
        if (name == entry.name) return entry.value;
    }
    return 0;
}

// What is to happen to this call: the rule's WHAT, or "" if it goes through.
std::string fault_of(const char* call, const std::string& path) {
    if (rules().empty() || !chosen(path)) return "";
    for (Rule& rule : rules()) {
        if (rule.call != call) continue;
        const long now = ++rule.seen;
        if (now != rule.nth && !(rule.and_later && now > rule.nth)) continue;
        mark_hit();
        if (rule.what == "kill") ::kill(::getpid(), SIGKILL);
        if (rule.what == "term") ::kill(::getpid(), SIGTERM), ::usleep(1'000'000);
        return rule.what;
    }
    return "";
}

// Runs `transfer(count)`, the real call for `count` bytes, as the fault says.
template <class Transfer>
ssize_t transfer_with(const std::string& fault, std::size_t count, const Transfer& transfer) {
    if (const int error = errno_named(fault)) {
        errno = error;
        return -1;
    }
    if (fault == "zero") return 0;
    if (fault == "slow") ::usleep(200'000);
    const ssize_t done = transfer(fault == "short" && count > 1 ? count / 2 : count);
    if (fault == "kill-after") ::kill(::getpid(), SIGKILL);
    return done;
}

template <class Call>
int call_with(const std::string& fault, const Call& call) {
    return static_cast<int>(
        transfer_with(fault == "short" || fault == "zero" ? "" : fault, 0, [&](std::size_t) { return call(); }));
}

std::vector<unsigned char> flipped_if(const std::string& fault, const void* bytes, std::size_t count) {
    if (fault != "flip" || count == 0) return {};
    const auto* const first = static_cast<const unsigned char*>(bytes);
    std::vector<unsigned char> copy(first, first + count);
    copy[count / 2] ^= 0x10;
    return copy;
}

void flip_if(const std::string& fault, void* bytes, ssize_t count) {
    if (fault == "flip" && count > 0) static_cast<unsigned char*>(bytes)[count / 2] ^= 0x10;
}

int open_any(const char* name, const char* path, int flags, mode_t mode) {
    const auto real = next<int(const char*, int, ...)>(name);
    const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
    return call_with(creates ? fault_of("create", absolute(path)) : "", [&] { return real(path, flags, mode); });
}

mode_t mode_argument(int flags, va_list arguments) {
    const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
    return creates ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* bytes, std::size_t count) {
    static const auto real = next<ssize_t(int, const void*, std::size_t)>("write");
    const std::string fault = fault_of("write", path_of(fd));
    const std::vector<unsigned char> flipped = flipped_if(fault, bytes, count);
    return transfer_with(fault, count, [&](std::size_t n) { return real(fd, flipped.empty() ? bytes : flipped.data(), n); });
}
ssize_t pwrite(int fd, const void* bytes, std::size_t count, off_t at) {
    static const auto real = next<ssize_t(int, const void*, std::size_t, off_t)>("pwrite");
    const std::string fault = fault_of("write", path_of(fd));
    const std::vector<unsigned char> flipped = flipped_if(fault, bytes, count);
    return transfer_with(fault, count, [&](std::size_t n) { return real(fd, flipped.empty() ? bytes : flipped.data(), n, at); });
}
ssize_t pwrite64(int fd, const void* bytes, std::size_t count, off64_t at) { return pwrite(fd, bytes, count, at); }

ssize_t read(int fd, void* bytes, std::size_t count) {
    static const auto real = next<ssize_t(int, void*, std::size_t)>("read");
    const std::string fault = fault_of("read", path_of(fd));
    const ssize_t got = transfer_with(fault, count, [&](std::size_t n) { return real(fd, bytes, n); });
    flip_if(fault, bytes, got);
    return got;
}
ssize_t pread(int fd, void* bytes, std::size_t count, off_t at) {
    static const auto real = next<ssize_t(int, void*, std::size_t, off_t)>("pread");
    const std::string fault = fault_of("read", path_of(fd));
    const ssize_t got = transfer_with(fault, count, [&](std::size_t n) { return real(fd, bytes, n, at); });
    flip_if(fault, bytes, got);
    return got;
}
ssize_t pread64(int fd, void* bytes, std::size_t count, off64_t at) { return pread(fd, bytes, count, at); }

ssize_t copy_file_range(int from, off64_t* from_at, int to, off64_t* to_at, std::size_t count, unsigned flags) {
    static const auto real = next<ssize_t(int, off64_t*, int, off64_t*, std::size_t, unsigned)>("copy_file_range");
    const std::string fault = fault_of("copy", path_of(to));
    const off64_t begin = to_at ? *to_at : 0;
    const ssize_t copied = transfer_with(fault, count, [&](std::size_t n) { return real(from, from_at, to, to_at, n, flags); });
    unsigned char middle = 0;
    if (fault == "flip" && to_at && copied > 0 && pread(to, &middle, 1, begin + copied / 2) == 1) {
        middle ^= 0x10;
        if (pwrite(to, &middle, 1, begin + copied / 2) != 1) return -1;
    }
    return copied;
}

int fsync(int fd) {
    static const auto real = next<int(int)>("fsync");
    return call_with(fault_of("sync", path_of(fd)), [&] { return real(fd); });
}
int fdatasync(int fd) {
    static const auto real = next<int(int)>("fdatasync");
    return call_with(fault_of("sync", path_of(fd)), [&] { return real(fd); });
}

int link(const char* from, const char* to) {
    static const auto real = next<int(const char*, const char*)>("link");
    return call_with(fault_of("link", absolute(to)), [&] { return real(from, to); });
}
int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
    static const auto real = next<int(int, const char*, int, const char*, int)>("linkat");
    return call_with(fault_of("link", absolute(to)), [&] { return real(from_folder, from, to_folder, to, flags); });
}
int rename(const char* from, const char* to) {
    static const auto real = next<int(const char*, const char*)>("rename");
    return call_with(fault_of("link", absolute(to)), [&] { return real(from, to); });
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
    static const auto real = next<int(int, const char*, int, const char*, unsigned)>("renameat2");
    const std::string fault = fault_of("renameat2", absolute(to));
    return call_with(fault.empty() ? fault_of("link", absolute(to)) : fault,
                     [&] { return real(from_folder, from, to_folder, to, flags); });
}
int mkdir(const char* path, mode_t mode) {
    static const auto real = next<int(const char*, mode_t)>("mkdir");
    return call_with(fault_of("mkdir", absolute(path)), [&] { return real(path, mode); });
}
int flock(int fd, int operation) {
    static const auto real = next<int(int, int)>("flock");
    return call_with(fault_of("lock", path_of(fd)), [&] { return real(fd, operation); });
}
int unlinkat(int folder, const char* path, int flags) {
    static const auto real = next<int(int, const char*, int)>("unlinkat");
    const std::string whole = path[0] == '/' || folder == AT_FDCWD ? absolute(path) : path_of(folder) + "/" + path;
    return call_with(fault_of("unlink", whole), [&] { return real(folder, path, flags); });
}
int unlink(const char* path) {
    static const auto real = next<int(const char*)>("unlink");
    return call_with(fault_of("unlink", absolute(path)), [&] { return real(path); });
}

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    return open_any("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    return open_any("open64", path, flags, mode);
}

}  // extern "C"
