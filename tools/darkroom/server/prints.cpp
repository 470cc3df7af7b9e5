#include "tools/darkroom/server/prints.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <span>
#include <utility>

#include "base/cli.h"
#include "base/file.h"
#include "base/parse.h"
#include "tools/darkroom/server/spawn.h"

namespace latent::darkroom {

namespace {

constexpr std::size_t kMost = 100;
constexpr int kRecipeDescriptor = 3;

bool is_over(PrintState state) { return state != PrintState::kWaiting && state != PrintState::kRunning; }

struct Started {
    pid_t child = 0;
    int messages = -1;  // its standard error: a terminal, since tools draw how far they are on these
};

// A terminal of one long row; its other end in `name`.
Result<int> open_terminal(std::string& name) {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    char other[64];
    const struct winsize size { .ws_row = 1, .ws_col = 200, .ws_xpixel = 0, .ws_ypixel = 0 };
    if (terminal >= 0 && ::grantpt(terminal) == 0 && ::unlockpt(terminal) == 0 && ::ptsname_r(terminal, other, sizeof other) == 0 &&
        ::ioctl(terminal, TIOCSWINSZ, &size) == 0) {
        name = other;
        return terminal;
    }
    if (terminal >= 0) ::close(terminal);
    return Error{ErrorCode::kIo, "cannot open a terminal for latent-print"};
}

// A row of that terminal: a message; or "developing [###...]  37%  2m left", and how far it is.
void read_row(std::string row, PrintJob& job) {
    for (std::size_t at = 0; (at = row.find("\033[K")) != std::string::npos;) row.erase(at, 3);
    const std::size_t percent = row.find('%'), bar = row.find('[');
    const std::size_t digits = percent == std::string::npos ? percent : row.find_last_not_of("0123456789", percent - 1) + 1;
    const Result<std::uint64_t> done =
        percent == std::string::npos ? Result<std::uint64_t>(Error{}) : parse_count(row.substr(digits, percent - digits));
    if (row.empty()) return;
    job.done = done && bar < digits ? std::optional(static_cast<double>(*done) / 100) : std::nullopt;
    if (!job.done) {
        job.message = row;
        return;
    }
    const std::size_t rest = row.find_first_not_of(' ', percent + 1);
    job.message = row.substr(0, row.find(' ')) + (rest == std::string::npos ? "" : ", " + row.substr(rest));
}

Result<Started> start(const std::vector<std::string>& command, int recipe) {
    std::string other_end;
    const Result<int> terminal = open_terminal(other_end);
    if (!terminal) return terminal.error();
    SpawnFiles files;
    files.open(STDIN_FILENO, "/dev/null", O_RDONLY);
    files.open(STDOUT_FILENO, "/dev/null", O_WRONLY);
    files.open(STDERR_FILENO, other_end, O_WRONLY | O_NOCTTY);
    files.copy(recipe, kRecipeDescriptor);
    const Result<pid_t> child = spawn(command, files);
    if (child) return Started{*child, *terminal};
    ::close(*terminal);
    return child.error();
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
    const auto show = [&] {
        const std::scoped_lock lock(mutex_);
        if (Order* const kept = find(order.id)) read_row(std::exchange(line, ""), *kept);
    };
    char buffer[4096];
    for (ssize_t got = 0; (got = ::read(started->messages, buffer, sizeof buffer)) > 0 || (got < 0 && errno == EINTR);) {
        for (ssize_t i = 0; i < got; ++i) {
            if (buffer[i] == '\n' || buffer[i] == '\r' || line.size() == 1000) show();
            if (buffer[i] != '\n' && buffer[i] != '\r') line += buffer[i];
        }
        const std::string begun = line;  // a bar is a row that nothing ends
        show();
        line = begun;
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
    if (kept->done) kept->message.clear();
    kept->done.reset();
    kept->state = done ? PrintState::kDone : PrintState::kFailed;
}

}  // namespace latent::darkroom
