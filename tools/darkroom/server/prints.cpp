#include "tools/darkroom/server/prints.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <span>
#include <utility>

#include "base/cli.h"
#include "base/file.h"

namespace latent::darkroom {

namespace {

constexpr std::size_t kMost = 100;
constexpr int kRecipeDescriptor = 3;

bool is_over(PrintState state) { return state != PrintState::kWaiting && state != PrintState::kRunning; }

struct Started {
    pid_t child = 0;
    int messages = -1;  // its standard error
};

Result<Started> start(const std::vector<std::string>& command, int recipe) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return Error{ErrorCode::kIo, "cannot make a pipe"};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
    posix_spawn_file_actions_adddup2(&actions, recipe, kRecipeDescriptor);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    Started started{0, ends[0]};
    const int failed = ::posix_spawn(&started.child, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[1]);
    if (failed == 0) return started;
    ::close(ends[0]);
    return Error{ErrorCode::kIo, command.front() + ": cannot be started"};
}

}  // namespace

Prints::Prints(std::vector<std::string> command) : command_(std::move(command)), worker_([this] { work(); }) {}

Prints::~Prints() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
        if (child_ > 0) ::kill(child_, SIGTERM);
    }
    changed_.notify_all();
    worker_.join();
}

Result<std::uint64_t> Prints::add(const std::filesystem::path& output, const Recipe& recipe, bool replace) {
    const std::scoped_lock lock(mutex_);
    if (orders_.size() >= kMost) {
        const auto over = std::ranges::find_if(orders_, is_over, &Order::state);
        if (over == orders_.end()) return Error{ErrorCode::kIo, fmt::format("{} prints are waiting already", kMost)};
        orders_.erase(over);
    }
    Order order;
    order.id = ++last_id_;
    order.name = output.filename().string();
    order.output = output;
    order.recipe = recipe.dump(-1, ' ', true);
    order.replace = replace;
    orders_.push_back(std::move(order));
    changed_.notify_all();
    return last_id_;
}

void Prints::cancel(std::uint64_t id) {
    const std::scoped_lock lock(mutex_);
    Order* const order = find(id);
    if (!order || is_over(order->state)) return;
    if (order->state == PrintState::kRunning && child_ > 0) ::kill(child_, SIGTERM);
    order->state = PrintState::kCancelled;
}

std::vector<PrintJob> Prints::list() const {
    const std::scoped_lock lock(mutex_);
    return {orders_.begin(), orders_.end()};
}

Prints::Order* Prints::find(std::uint64_t id) {
    const auto found = std::ranges::find(orders_, id, &Order::id);
    return found == orders_.end() ? nullptr : &*found;
}

void Prints::work() {
    for (;;) {
        std::unique_lock lock(mutex_);
        const auto next = [this] { return std::ranges::find(orders_, PrintState::kWaiting, &Order::state); };
        changed_.wait(lock, [&] { return ends_ || next() != orders_.end(); });
        if (ends_) return;
        next()->state = PrintState::kRunning;
        const Order order = *std::ranges::find(orders_, PrintState::kRunning, &Order::state);
        lock.unlock();
        make(order);
    }
}

void Prints::make(const Order& order) {
    std::vector<std::string> command = command_;
    command.insert(command.end(), {"--recipe", fmt::format("/dev/fd/{}", kRecipeDescriptor), "-o", order.output.string()});
    if (order.replace) command.emplace_back("--force");
    Status ready;
    Result<File> recipe = File::create_in_memory();
    if (recipe) ready = recipe->write_all(0, std::as_bytes(std::span(order.recipe)));
    Result<Started> started = !recipe ? recipe.error() : !ready ? ready.error() : Result<Started>(Started{});
    {
        const std::scoped_lock lock(mutex_);
        Order* const kept = find(order.id);
        if (!kept || kept->state == PrintState::kCancelled || ends_) return;
        if (started) started = start(command, recipe->descriptor());
        if (!started) {
            kept->state = PrintState::kFailed;
            kept->message = started.error().message;
            return;
        }
        child_ = started->child;
    }
    std::string line;
    char buffer[4096];
    for (ssize_t got = 0; (got = ::read(started->messages, buffer, sizeof buffer)) > 0 || (got < 0 && errno == EINTR);) {
        for (ssize_t i = 0; i < got; ++i) {
            if (buffer[i] != '\n' && line.size() < 1000) {
                line += buffer[i];
                continue;
            }
            const std::scoped_lock lock(mutex_);
            if (Order* const kept = find(order.id)) kept->message = line;
            line.clear();
        }
    }
    ::close(started->messages);
    siginfo_t info{};  // it stays a child, whose number is its own, until `cancel` cannot use that any more
    while (::waitid(P_PID, static_cast<id_t>(started->child), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) continue;
    const std::scoped_lock lock(mutex_);
    int status = 0;
    while (::waitpid(started->child, &status, 0) < 0 && errno == EINTR) continue;
    child_ = 0;
    Order* const kept = find(order.id);
    if (!kept || kept->state == PrintState::kCancelled) return;
    const bool done = WIFEXITED(status) && (WEXITSTATUS(status) == cli::kDone || WEXITSTATUS(status) == cli::kDoneWithLosses);
    kept->state = done ? PrintState::kDone : PrintState::kFailed;
}

}  // namespace latent::darkroom
