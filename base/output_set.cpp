#include "base/output_set.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "base/file.h"
#include "base/hidden_name.h"

namespace latent {

namespace fs = std::filesystem;

namespace {

bool is_taken(const fs::path& name) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(name, ignored));
}

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
    remove_abandoned(items[0].name);
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

fs::path OutputSet::place(std::size_t i) const { return hidden_.path() / fmt::format("{}", i); }

Status OutputSet::publish() {
    const auto held = hold_signals();
    const auto old = [this](std::size_t i) { return hidden_.path() / fmt::format("{}.old", i); };
    const std::size_t count = items_.size();
    // The last item goes first and comes last: while it is there, it belongs to the others.
    if (replace_) ::rename(items_[count - 1].name.c_str(), old(count - 1).c_str());
    for (std::size_t i = 0; i < count; ++i) {
        const fs::path& name = items_[i].name;
        if (replace_ && i + 1 < count) ::rename(name.c_str(), old(i).c_str());
        const int failed = rename_without_replacing(place(i), name);
        if (failed == 0) continue;
        for (std::size_t named = 0; named < i; ++named) ::rename(items_[named].name.c_str(), place(named).c_str());
        for (std::size_t k = 0; k < count; ++k) rename_without_replacing(old(k), items_[k].name);
        return error_from_errno(failed, name.string(),
                                items_[i].is_folder ? "cannot name the finished folder" : "cannot name the finished file");
    }
    const Status synced = sync_folder(folder_of(items_[0].name));
    hidden_ = {};
    if (synced) return {};
    return Error{synced.error().code,
                 fmt::format("{}: complete and in place, but {}", items_.back().name.string(), synced.error().message)};
}

}  // namespace latent
