#include "sampledb/read/footer_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/hash.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kReadPiece = std::uint64_t{1} << 20;  // bytes read at once

}  // namespace

Result<FooterFrame> read_footer_end(const ByteSource& source) {
    if (source.size() < kFooterHeadSize) return Error{ErrorCode::kTruncated, "has no footer"};
    std::array<std::byte, kFooterHeadSize> end;
    if (Status s = source.read(source.size() - end.size(), end); !s) return s.error();
    return decode_footer_end(end, source.size());
}

Result<FooterReader> FooterReader::open(const ByteSource& source, const FooterFrame& end) {
    FooterReader footer(source, end);
    Bytes head(end.head_size());
    if (Status s = source.read(end.offset, head); !s) return s.error();
    if (Status s = decode_footer_head(head, source.size(), footer.frame_); !s) return s.error();
    if (Status s = footer.check_hashes(); !s) return s.error();
    return footer;
}

Status FooterReader::check_hashes() const {
    const FooterFrame& f = frame_;
    const auto check = [this](std::uint64_t begin, std::uint64_t end, std::uint64_t expected) -> Status {
        const Result<std::uint64_t> hash = hash_of(begin, end - begin);
        if (!hash) return hash.error();
        return *hash == expected ? Status{} : corrupt("footer checksum mismatch");
    };
    const std::uint64_t end = f.provenance_at() + f.provenance_size;
    if (f.first_form) return check(f.offset, end, f.entries_hash);
    if (Status s = check(f.entries_at(), f.provenance_at(), f.entries_hash); !s) return s;
    return check(f.provenance_at(), end, f.provenance_hash);
}

Result<std::uint64_t> FooterReader::hash_of(std::uint64_t begin, std::uint64_t size) const {
    Hasher64 hasher;
    Bytes piece(std::min(size, kReadPiece));
    for (std::uint64_t done = 0; done < size;) {
        const std::span<std::byte> bytes = std::span(piece).first(std::min(size - done, kReadPiece));
        if (Status s = source_->read(begin + done, bytes); !s) return s.error();
        hasher.update(bytes);
        done += bytes.size();
    }
    return hasher.digest();
}

Status FooterReader::for_each_run(std::uint64_t begin, const JobId& job, const std::function<void(const RunInfo&)>& visit) const {
    if (run_count() > kMaxRunsPerFile) {
        return Error{ErrorCode::kOutOfRange, fmt::format("it lists {} runs; the maximum is {}", run_count(), kMaxRunsPerFile)};
    }
    if (begin > offset()) return corrupt("the footer begins inside the header");
    const std::size_t entry_size = frame_.entry_size();
    const std::uint64_t at_once = kReadPiece / entry_size;
    Bytes piece(std::min(run_count(), at_once) * entry_size);
    std::uint64_t reached = begin;
    for (std::uint64_t i = 0; i < run_count();) {
        const std::span<std::byte> entries = std::span(piece).first(std::min(run_count() - i, at_once) * entry_size);
        if (Status s = source_->read(frame_.entries_at() + i * entry_size, entries); !s) return s;
        for (std::size_t at = 0; at < entries.size(); at += entry_size, ++i) {
            const Result<RunHeader> header = decode_footer_entry(frame_, entries.subspan(at, entry_size), reached);
            if (!header) return header.error().at(fmt::format("its run {}", i));
            if (header->job != job) return corrupt(fmt::format("its run {} belongs to another job", i));
            if (header->size() > offset() - reached) return corrupt(fmt::format("its run {} reaches into the footer", i));
            visit({reached, *header});
            reached += header->size();
        }
    }
    return reached == offset() ? Status{} : corrupt(fmt::format("it lists no run at byte {}", reached));
}

Result<std::string> FooterReader::provenance() const {
    if (frame_.provenance_size > kMaxFooterProvenance) return std::string();
    std::string text(frame_.provenance_size, '\0');
    if (Status s = source_->read(frame_.provenance_at(), std::as_writable_bytes(std::span(text))); !s) return s.error();
    return text;
}

}  // namespace latent::sampledb
