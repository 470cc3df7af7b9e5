#include "tests/faults/process.h"

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "base/file.h"

extern char** environ;

namespace latent::testing {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what + ": " + std::strerror(errno)); }

// Starts `command` with its standard output and error on these descriptors (-1: inherited).
pid_t start(const std::vector<std::string>& command, const Environment& environment, int out, int err) {
    std::map<std::string, std::string> variables;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry;
        variables[text.substr(0, text.find('='))] = text.substr(std::min(text.find('='), text.size() - 1) + 1);
    }
    for (const auto& [name, value] : environment) variables[name] = value;
    std::vector<std::string> lines;
    for (const auto& [name, value] : variables) lines.push_back(name + "=" + value);
    std::vector<char*> argv, envp;
    for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
    for (const std::string& line : lines) envp.push_back(const_cast<char*>(line.c_str()));
    argv.push_back(nullptr);
    envp.push_back(nullptr);

    const pid_t pid = ::fork();
    if (pid < 0) fail("fork");
    if (pid == 0) {
        if (out >= 0) ::dup2(out, STDOUT_FILENO);
        if (err >= 0) ::dup2(err, STDERR_FILENO);
        ::execve(argv[0], argv.data(), envp.data());
        ::_exit(127);
    }
    return pid;
}

int exit_status(int status) { return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status); }

}  // namespace

Outcome run(const std::vector<std::string>& command, const Environment& environment) {
    TemporaryFolder scratch;
    const int out = ::open((scratch / "out").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    const int err = ::open((scratch / "err").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (out < 0 || err < 0) fail("open");
    const auto begin = std::chrono::steady_clock::now();
    const pid_t pid = start(command, environment, out, err);
    int status = 0;
    struct rusage usage {};
    while (::wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    ::close(out);
    ::close(err);
    Outcome outcome;
    outcome.status = exit_status(status);
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    outcome.peak_rss_kib = usage.ru_maxrss;
    outcome.out = read_text(scratch / "out");
    outcome.err = read_text(scratch / "err");
    return outcome;
}

Child::Child(const std::vector<std::string>& command, const Environment& environment) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail("pipe");
    pid_ = start(command, environment, ends[1], -1);
    ::close(ends[1]);
    out_ = ends[0];
}

Child::~Child() {
    kill_now();
    wait();
    ::close(out_);
}

void Child::kill_now() { send(SIGKILL); }

void Child::send(int signal) {
    if (pid_ > 0) ::kill(pid_, signal);
}

int Child::wait() {
    if (pid_ <= 0) return -1;
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return exit_status(status);
}

std::string Child::drain() {
    std::string text;
    char buffer[4096];
    for (;;) {
        const ssize_t got = ::read(out_, buffer, sizeof buffer);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return text;
        text.append(buffer, static_cast<std::size_t>(got));
    }
}

Outcome run_python(const std::string& script, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {"/usr/bin/env", "python3", "-B", in_tree(script)};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run(command);
}

Environment environment_of(const Fault& fault) {
    return {{"LD_PRELOAD", tool("liblatent_fault_shim.so")},
            {"LATENT_FAULT", fault.rule},
            {"LATENT_FAULT_PATH", fault.path},
            {"ASAN_OPTIONS", "verify_asan_link_order=0"}};
}

FaultOutcome run_with_fault(const std::vector<std::string>& command, const Fault& fault, const Environment& environment) {
    TemporaryFolder scratch;
    Environment all = environment_of(fault);
    all.insert(all.end(), environment.begin(), environment.end());
    all.emplace_back("LATENT_FAULT_HIT", (scratch / "hit").string());
    FaultOutcome outcome;
    static_cast<Outcome&>(outcome) = run(command, all);
    outcome.happened = fs::exists(scratch / "hit");
    return outcome;
}

FaultOutcome run_exhausted(const std::vector<std::string>& command, const std::string& rule) {
    TemporaryFolder scratch;
    FaultOutcome outcome;
    static_cast<Outcome&>(outcome) = run(command, {{"LD_PRELOAD", tool("liblatent_exhaustion_shim.so")},
                                                   {"LATENT_EXHAUST", rule},
                                                   {"LATENT_FAULT_HIT", (scratch / "hit").string()}});
    outcome.happened = fs::exists(scratch / "hit");
    return outcome;
}

TemporaryFolder::TemporaryFolder() : TemporaryFolder(fs::temp_directory_path()) {}

TemporaryFolder::TemporaryFolder(const fs::path& parent) : path_(parent / ("latent-test-" + make_nonce())) {
    fs::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::names() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

SmallDisk::SmallDisk(std::uint64_t bytes) {
    mounted_ = ::mount("latent-test", folder_.path().c_str(), "tmpfs", 0, ("size=" + std::to_string(bytes)).c_str()) == 0;
}

SmallDisk::~SmallDisk() {
    if (mounted_) ::umount2(folder_.path().c_str(), MNT_DETACH);
}

void SmallDisk::resize(std::uint64_t bytes) {
    if (::mount("latent-test", folder_.path().c_str(), "tmpfs", MS_REMOUNT, ("size=" + std::to_string(bytes)).c_str()) != 0)
        fail("remount");
}

SharingDisk::SharingDisk() {
    const fs::path image = image_ / "image";
    std::ofstream(image).close();
    fs::resize_file(image, std::uintmax_t{512} << 20);  // XFS wants 300 MB; it takes what is written
    const auto done = [](const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; };
    mounted_ = done("PATH=$PATH:/usr/sbin mkfs.xfs -q -m reflink=1 " + image.string()) &&
               done("mount -o loop " + image.string() + " " + folder_.path().string());
}

SharingDisk::~SharingDisk() {
    if (mounted_) ::umount2(folder_.path().c_str(), 0);
}

std::uint64_t SharingDisk::used() const {
    const int fd = ::open(folder_.path().c_str(), O_RDONLY | O_DIRECTORY);
    struct statvfs info {};
    if (fd < 0 || ::syncfs(fd) != 0 || ::fstatvfs(fd, &info) != 0) fail("look at a disk");
    ::close(fd);
    return (info.f_blocks - info.f_bfree) * info.f_frsize;
}

std::string read_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

}  // namespace latent::testing
