#include "base/naming_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstdio>

#include "base/file.h"
#include "base/small_file.h"

namespace latent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kName = "journal";

// "INODE SECONDS NANOSECONDS NAME" with a zero byte behind it.
std::string text_of(const NamingEntry& entry) {
    const Identity& id = entry.identity;
    return fmt::format("{} {} {} {}", id.inode, id.seconds, id.nanoseconds, entry.name) + '\0';
}

std::optional<NamingEntry> entry_from(std::string_view text) {
    NamingEntry entry;
    for (std::uint64_t* number : {&entry.identity.inode, &entry.identity.seconds, &entry.identity.nanoseconds}) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
        if (error != std::errc() || end == text.data() + text.size() || *end != ' ') return std::nullopt;
        text.remove_prefix(static_cast<std::size_t>(end + 1 - text.data()));
    }
    if (text.empty() || text.find('/') != std::string_view::npos) return std::nullopt;
    entry.name = text;
    return entry;
}

}  // namespace

std::optional<Identity> identity_of(const fs::path& path) {
    struct statx info;
    if (::statx(AT_FDCWD, path.c_str(), AT_SYMLINK_NOFOLLOW, STATX_INO | STATX_BTIME | STATX_MTIME, &info) != 0)
        return std::nullopt;
    const auto& time = (info.stx_mask & STATX_BTIME) != 0 ? info.stx_btime : info.stx_mtime;
    return Identity{info.stx_ino, static_cast<std::uint64_t>(time.tv_sec), time.tv_nsec};
}

Status write_naming_journal(const fs::path& hidden, const NamingJournal& journal) {
    std::string text;
    for (const NamingEntry& entry : journal) text += text_of(entry);
    const fs::path unfinished = hidden / "journal.new";
    Result<File> file = File::create_exclusive(unfinished);
    if (!file) return file.error();
    if (Status s = file->write_all(0, std::as_bytes(std::span(text))); !s) return s;
    if (Status s = file->sync_data(); !s) return s;
    if (::rename(unfinished.c_str(), (hidden / kName).c_str()) == 0) return {};
    return error_from_errno(errno, unfinished.string(), "cannot rename");
}

NamingJournal read_naming_journal(const fs::path& hidden) {
    constexpr std::uint64_t kMost = 1 << 16;
    const Result<std::string> text = read_small_file(hidden / kName, kMost, "a journal");
    if (!text) return {};
    NamingJournal journal;
    for (std::size_t at = 0, end = 0; (end = text->find('\0', at)) != std::string::npos; at = end + 1) {
        const std::optional<NamingEntry> entry = entry_from(std::string_view(*text).substr(at, end - at));
        if (!entry) return {};
        journal.push_back(*entry);
    }
    return journal;
}

}  // namespace latent
