#include "base/output_set.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

#include "base/file.h"
#include "base/hidden_name.h"
#include "base/naming_journal.h"

namespace latent {

namespace fs = std::filesystem;

namespace {

fs::path place_in(const fs::path& hidden, std::size_t i) { return hidden / fmt::format("{}", i); }
fs::path aside_in(const fs::path& hidden, std::size_t i) { return hidden / fmt::format("{}.old", i); }

bool is_taken(const fs::path& name) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(name, ignored));
}

// Gives `from` the name `to`; what had it is then at `from`. Where the file system cannot exchange them, by way of `aside`.
int rename_in_exchange(const fs::path& from, const fs::path& to, const fs::path& aside) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0) return 0;
    if (errno == ENOENT) return rename_without_replacing(from, to);
    if (errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) return errno;
    const bool taken = ::rename(to.c_str(), aside.c_str()) == 0;
    if (!taken && errno != ENOENT) return errno;
    if (const int failed = rename_without_replacing(from, to)) {
        if (taken) ::rename(aside.c_str(), to.c_str());
        return failed;
    }
    return taken && ::rename(aside.c_str(), from.c_str()) != 0 ? errno : 0;
}

// Takes back the names of a set of which not all were given, and gives them to what had them before.
void take_back(const fs::path& hidden, const NamingJournal& entries) {
    const fs::path folder = folder_of(hidden);
    std::size_t named = 0;
    for (const NamingEntry& entry : entries) named += identity_of(folder / entry.name) == entry.identity;
    if (named == entries.size()) return;
    for (std::size_t i = entries.size(); i-- > 0;) {
        const fs::path name = folder / entries[i].name;
        const fs::path aside = aside_in(hidden, i), place = place_in(hidden, i);
        const std::optional<Identity> at_place = identity_of(place);
        const fs::path old = is_taken(aside) ? aside : at_place && *at_place != entries[i].identity ? place : fs::path();
        if (identity_of(name) == entries[i].identity) {
            const fs::path away = hidden / fmt::format("{}.back", i);
            if (old.empty())
                rename_without_replacing(name, away);
            else
                rename_in_exchange(old, name, away);
        } else if (!old.empty() && !is_taken(name)) {
            rename_without_replacing(old, name);
        }
    }
}

// Held by whoever names a set of this first name, or takes names back. A killed holder leaves its file; the next one removes it.
class NamingLock {
 public:
    static Result<NamingLock> wait(const fs::path& first) {
        const fs::path path = folder_of(first) / fmt::format(".{}.lock", first.filename().string());
        for (;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
            const auto held = hold_signals();  // what a signal removes must be ours
            NamingLock lock;
            lock.fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
            if (lock.fd_ < 0) return error_from_errno(errno, first.string(), "cannot create");
            if (!lock_hidden(lock.fd_) || !is_named(lock.fd_, path))
                continue;  // the holder removes it, so the next is another file
            lock.path_ = TemporaryPath(path);
            return lock;
        }
    }
    NamingLock(NamingLock&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}
    NamingLock& operator=(NamingLock&&) = delete;
    ~NamingLock() {
        path_ = {};
        if (fd_ >= 0) ::close(fd_);
    }

 private:
    NamingLock() = default;
    TemporaryPath path_;
    int fd_ = -1;
};

Status check_free(const OutputSet::Item& item, bool replace) {
    std::error_code ignored;
    if (!is_taken(item.name)) return {};
    if (!replace) return Error{ErrorCode::kExists, item.name.string() + ": already exists; use --force to replace it"};
    if (item.is_folder ? fs::is_directory(item.name, ignored) : fs::is_regular_file(item.name, ignored)) return {};
    return Error{ErrorCode::kExists,
                 fmt::format("{}: exists and is not a {}; not replaced", item.name.string(), item.is_folder ? "folder" : "file")};
}

}  // namespace

Result<OutputSet> OutputSet::create(std::vector<Item> items, bool replace) {
    {
        const Result<NamingLock> lock = NamingLock::wait(items[0].name);
        if (!lock) return lock.error();
        remove_abandoned(items[0].name, [](const fs::path& hidden) { take_back(hidden, read_naming_journal(hidden)); });
    }
    for (const Item& item : items) {
        if (Status s = check_free(item, replace); !s) return s.error();
    }
    OutputSet set;
    set.items_ = std::move(items);
    set.replace_ = replace;
    if (Status s = set.make_hidden(); !s) return s.error();
    return set;
}

OutputSet::OutputSet(OutputSet&& other) noexcept
    : items_(std::move(other.items_)),
      replace_(other.replace_),
      hidden_(std::move(other.hidden_)),
      lock_(std::exchange(other.lock_, -1)) {}

OutputSet::~OutputSet() {
    hidden_ = {};
    if (lock_ >= 0) ::close(lock_);
}

Status OutputSet::make_hidden() {
    const fs::path& first = items_[0].name;
    for (;;) {
        hidden_ = TemporaryPath(hidden_name(first));
        if (::mkdir(hidden_.path().c_str(), 0777) != 0) return error_from_errno(errno, first.string(), "cannot create");
        lock_ = ::open(hidden_.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (lock_ < 0 && errno != ENOENT) return error_from_errno(errno, first.string(), "cannot open");
        if (lock_ < 0) continue;
        if (lock_hidden(lock_) && is_named(lock_, hidden_.path())) return {};
        ::close(std::exchange(lock_, -1));
    }
}

fs::path OutputSet::place(std::size_t i) const { return place_in(hidden_.path(), i); }

Status OutputSet::publish() {
    const auto held = hold_signals();
    NamingJournal journal;
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const std::optional<Identity> identity = identity_of(place(i));
        if (!identity) return error_from_errno(errno, items_[i].name.string(), "cannot read its attributes");
        journal.push_back({*identity, items_[i].name.filename().string()});
    }
    if (Status s = write_naming_journal(hidden_.path(), journal); !s) return s.error().at(items_[0].name.string());
    {
        const Result<NamingLock> lock = NamingLock::wait(items_[0].name);
        if (!lock) return lock.error();
        for (std::size_t i = 0; i < items_.size(); ++i) {
            const fs::path& name = items_[i].name;
            const int failed = replace_ ? rename_in_exchange(place(i), name, aside_in(hidden_.path(), i))
                                        : rename_without_replacing(place(i), name);
            if (failed == 0) continue;
            take_back(hidden_.path(), journal);
            return error_from_errno(failed, name.string(),
                                    items_[i].is_folder ? "cannot name the finished folder" : "cannot name the finished file");
        }
    }
    const Status synced = sync_folder(folder_of(items_[0].name));
    hidden_ = {};
    if (synced) return {};
    return Error{synced.error().code,
                 fmt::format("{}: complete and in place, but {}", items_.back().name.string(), synced.error().message)};
}

}  // namespace latent
