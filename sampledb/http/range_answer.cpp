#include "sampledb/http/range_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kMaxHeader = 256 << 10;  // bytes
constexpr std::uint64_t kMaxErrorPage = 64 << 10;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// The value of a header line "NAME: VALUE", if that is its name. `name`: in lower case.
std::optional<std::string_view> value_of(std::string_view line, std::string_view name) {
    if (line.size() <= name.size() || line[name.size()] != ':') return std::nullopt;
    if (!std::equal(name.begin(), name.end(), line.begin(), [](char a, char b) { return a == lower(b); })) return std::nullopt;
    line.remove_prefix(name.size() + 1);
    constexpr std::string_view kSpace = " \t\r\n";
    const std::size_t begin = line.find_first_not_of(kSpace);
    if (begin == line.npos) return "";
    return line.substr(begin, line.find_last_not_of(kSpace) + 1 - begin);
}

// Takes `before` and the number behind it off the front of `text`.
bool take_number(std::string_view& text, std::string_view before, std::uint64_t& number) {
    if (!text.starts_with(before)) return false;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + before.size(), end, number);
    text = std::string_view(rest, static_cast<std::size_t>(end - rest));
    return error == std::errc();
}

Error io_error(std::string message) { return {ErrorCode::kIo, std::move(message)}; }

}  // namespace

bool RangeAnswer::take_header(std::string_view line) {
    header_bytes_ += line.size();
    if (took_bytes_) return header_bytes_ <= kMaxHeader;  // trailers: what they say of the bytes comes too late
    if (line.starts_with("HTTP/")) {
        status_ = 0;
        std::from_chars(line.data() + std::min(line.find(' '), line.size() - 1) + 1, line.data() + line.size(), status_);
        version_.reset();
        modified_.clear();
        length_ = 0;
        encoded_ = false;
    } else if (const auto range = value_of(line, "content-range")) {
        // "bytes 0-4095/1000000", or "bytes */1000000" if the range is not there
        std::string_view text = *range;
        std::uint64_t last = 0, size = 0;
        version_.reset();
        const bool none = text.starts_with("bytes *");
        const bool valid = none ? take_number(text, "bytes */", size)
                                : take_number(text, "bytes ", first_) && take_number(text, "-", last) &&
                                      take_number(text, "/", size) && first_ <= last && last < size;
        if (valid && text.empty() && size <= std::numeric_limits<std::int64_t>::max()) version_ = RemoteVersion{size, ""};
        announced_ = version_ && !none ? last - first_ + 1 : 0;
    } else if (const auto modified = value_of(line, "last-modified")) {
        modified_ = *modified;
    } else if (const auto length = value_of(line, "content-length")) {
        std::string_view text = *length;
        if (!take_number(text, "", length_)) length_ = 0;
    } else if (const auto encoding = value_of(line, "content-encoding")) {
        encoded_ = *encoding != "identity";
    }
    if (version_) version_->modified = modified_;
    return header_bytes_ <= kMaxHeader;
}

bool RangeAnswer::take_bytes(ByteSpan bytes) {
    received_ += bytes.size();
    if (status_ != 206) return status_ / 100 != 2 && received_ <= kMaxErrorPage;
    const std::uint64_t surplus = received_ - std::min(received_, announced_);
    if (!verdict_on_range(false)) return false;
    took_bytes_ = true;
    into_.insert(into_.end(), bytes.begin(),
                 bytes.end() - static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(surplus, bytes.size())));
    return received_ < announced_ || length_ > 0;  // without a length, the range is where the answer ends
}

Status RangeAnswer::verdict(bool whole) const {
    if (header_bytes_ > kMaxHeader) return io_error("the server sends a header without end");
    if (!whole && received_ == 0 && status_ < 300) return {};  // the rest of the header may be missing
    switch (status_) {
        case 206:
            return verdict_on_range(whole);
        case 200:
            return io_error("the server sends only whole files; it must support range requests");
        case 416:  // no such range
            if (version_ && version_->size > offset_) return io_error("the server refuses a range that it has (status 416)");
            if (version_ && known_ == nullptr) return {};  // an empty file
            if (!version_) return io_error("the server has no such range of bytes (status 416)");
            return verdict_on_version();
        case 401:
        case 403:
            return io_error(fmt::format("the server refuses access (status {})", status_));
        case 404:
        case 410:
            return Error{ErrorCode::kNotFound, "there is no such file on the server"};
    }
    const bool is_redirection = status_ / 100 == 3 && !whole;  // one that is not followed: the transfer's own error says why
    const bool passes = status_ == 0 || status_ >= 500 || status_ == 408 || status_ == 429 || is_redirection;
    return passes ? Status{} : io_error(fmt::format("the server answers with status {}", status_));
}

Status RangeAnswer::verdict_on_range(bool whole) const {
    if (encoded_) return io_error("the server sends compressed bytes (Content-Encoding); it must send the file as it is");
    if (!version_) return io_error("the server does not say which bytes it sends, and of how many (Content-Range)");
    if (first_ != offset_ || announced_ > size_)
        return io_error("the server returned another range of bytes than the one requested");
    if (length_ > announced_) return io_error(fmt::format("the server announced {} bytes and sends {}", announced_, length_));
    if (whole && received_ < announced_)
        return io_error(fmt::format("the server announced {} bytes and sent {}", announced_, received_));
    return verdict_on_version();
}

// A file that grows is read up to where it ended when it was opened.
Status RangeAnswer::verdict_on_version() const {
    if (known_ == nullptr || version_->size > known_->size) return {};
    if (version_->size < known_->size)
        return io_error(fmt::format("has become shorter on the server since it was opened: it ends at byte {}", version_->size));
    const bool same = version_->modified == known_->modified || version_->modified.empty() || known_->modified.empty();
    return same ? Status{} : io_error("has changed on the server since it was opened");
}

}  // namespace latent::sampledb
