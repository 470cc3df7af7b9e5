// tools/darkroom/server/prints.h: a queue of prints, each made by latent-print in a process of its own.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/recipe.h"
#include "base/result.h"

namespace latent::darkroom {

enum class PrintState : std::uint8_t { kWaiting, kRunning, kDone, kFailed, kCancelled };

struct PrintJob {
    std::uint64_t id = 0;
    std::string name;  // the output's
    PrintState state = PrintState::kWaiting;
    std::string message;           // the last line that latent-print wrote
    std::optional<double> done{};  // 0..1, of what the message says
};

class Prints {
 public:
    // `command`: latent-print and what goes before --recipe.
    explicit Prints(std::vector<std::string> command);
    ~Prints();  // ends the one that runs
    Prints(const Prints&) = delete;
    Prints& operator=(const Prints&) = delete;

    // Errors: kIo, if there are 100 of them already that are not finished.
    Result<std::uint64_t> add(const std::filesystem::path& output, const Recipe& recipe, bool replace);
    void cancel(std::uint64_t id);
    std::vector<PrintJob> list() const;  // the last 100

 private:
    struct Order : PrintJob {
        std::filesystem::path output;
        std::string recipe;  // JSON
        bool replace = false;
    };
    void work();
    void make(const Order& order);
    Order* find(std::uint64_t id);

    const std::vector<std::string> command_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Order> orders_;
    std::uint64_t last_id_ = 0;
    pid_t child_ = 0;
    bool ends_ = false;
    std::thread worker_;
};

}  // namespace latent::darkroom
