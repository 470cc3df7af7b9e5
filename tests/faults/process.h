// tests/faults/process.h: runs a tool as a child process, with or without faults from tests/faults/fault_shim.cpp.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/paths.h"

namespace latent::testing {

struct Outcome {
    int status = -1;       // exit status; 128 + signal if a signal ended it
    std::string out, err;  // what it printed
    double seconds = 0;    // wall clock
    long peak_rss_kib = 0;
};

using Environment = std::vector<std::pair<std::string, std::string>>;

// Runs `command` (program and arguments; no shell) with these variables added to the environment, and waits for its end.
Outcome run(const std::vector<std::string>& command, const Environment& environment = {});

// Runs a Python script, named from the root of the source tree.
Outcome run_python(const std::string& script, const std::vector<std::string>& arguments);

// A child with its standard output in a pipe, for tests that watch it and end it at a moment of their choice.
class Child {
 public:
    explicit Child(const std::vector<std::string>& command, const Environment& environment = {});
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child();         // kills it if it still runs
    void kill_now();  // SIGKILL
    void send(int signal);
    int wait();           // exit status, 128 + signal
    std::string drain();  // everything it printed on standard output, until that was closed

 private:
    pid_t pid_ = -1;
    int out_ = -1;
};

struct Fault {
    std::string rule;  // "write:3:ENOSPC", as fault_shim.cpp explains
    std::string path;  // only files whose path contains this
};

struct FaultOutcome : Outcome {
    bool happened = false;  // the rule met its call
};

Environment environment_of(const Fault& fault);
FaultOutcome run_with_fault(const std::vector<std::string>& command, const Fault& fault, const Environment& environment = {});

// With memory or threads that run out: tests/faults/exhaustion_shim.cpp explains the rules ("memory:100+").
FaultOutcome run_exhausted(const std::vector<std::string>& command, const std::string& rule);

// A new empty folder, removed with everything in it at the end.
class TemporaryFolder {
 public:
    TemporaryFolder();
    explicit TemporaryFolder(const std::filesystem::path& parent);
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder();
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    // Sorted names of what is in it.
    std::vector<std::string> names() const;

 private:
    std::filesystem::path path_;
};

// A disk of a few bytes (a tmpfs), for tests that fill it. Where mounting is not permitted `mounted()` is false: skip, saying so.
class SmallDisk {
 public:
    explicit SmallDisk(std::uint64_t bytes);
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    ~SmallDisk();
    bool mounted() const { return mounted_; }
    void resize(std::uint64_t bytes);
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    std::vector<std::string> names() const { return folder_.names(); }

 private:
    TemporaryFolder folder_;
    bool mounted_ = false;
};

// A disk whose files can share blocks: XFS in an image of its own. Needs mkfs.xfs, a loop device and the right to mount; where one
// of these is missing `mounted()` is false: skip, saying so.
class SharingDisk {
 public:
    SharingDisk();
    SharingDisk(const SharingDisk&) = delete;
    SharingDisk& operator=(const SharingDisk&) = delete;
    ~SharingDisk();
    bool mounted() const { return mounted_; }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    std::uint64_t used() const;  // bytes, of everything that was written

 private:
    TemporaryFolder image_, folder_;
    bool mounted_ = false;
};

std::string read_text(const std::filesystem::path& path);

}  // namespace latent::testing
