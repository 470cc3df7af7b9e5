#include "sampledb/read/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/hash.h"
#include "sampledb/codec/page_codec.h"

namespace latent::sampledb {

namespace {

// `size` bytes at `offset`, or as many as there are.
Result<Bytes> read_up_to(const ByteSource& source, std::uint64_t offset, std::uint64_t size) {
    const std::uint64_t there = offset < source.size() ? source.size() - offset : 0;
    Bytes bytes(std::min(size, there));
    if (Status s = source.read(offset, bytes); !s) return s.error();
    return bytes;
}

struct HeaderCopy {
    FileHeader header;
    std::uint64_t size = 0;
};

Result<HeaderCopy> read_header_copy(const ByteSource& source, std::uint64_t offset) {
    std::uint64_t size = 0;
    for (std::uint64_t ask = kBlock;; ask = size) {
        const Result<Bytes> bytes = read_up_to(source, offset, ask);
        if (!bytes) return bytes.error();
        Result<FileHeader> header = decode_file_header(*bytes, &size);
        if (header) return HeaderCopy{std::move(*header), size};
        if (header.error().code != ErrorCode::kTruncated || size <= ask) return header.error();
    }
}

// The header from its first copy, else from the second, which begins at its own size. `damaged`: one of them is no use.
Result<HeaderCopy> read_header(const ByteSource& source, bool& damaged) {
    if (source.size() == 0) return Error{ErrorCode::kForeign, "is empty, not a Latent file"};
    Result<HeaderCopy> first = read_header_copy(source, 0);
    if (first) {
        const Result<HeaderCopy> second = read_header_copy(source, first->size);
        if (!second && second.error().code == ErrorCode::kIo) return second.error();
        damaged = !second;
        return first;
    }
    if (first.error().code != ErrorCode::kCorrupt && first.error().code != ErrorCode::kForeign) return first;
    damaged = true;
    for (std::uint64_t at = kBlock; at <= kMaxHeaderSize && at < source.size(); at += kBlock) {
        Result<HeaderCopy> second = read_header_copy(source, at);
        if (second ? second->size == at : second.error().code == ErrorCode::kIo) return second;
    }
    return first;
}

Result<Footer> read_footer(const ByteSource& source, std::uint64_t begin, const JobId& job, std::uint64_t& offset) {
    if (source.size() < begin + kFooterTrailerSize) return Error{ErrorCode::kTruncated, "has no footer"};
    const Result<Bytes> trailer = read_up_to(source, source.size() - kFooterTrailerSize, kFooterTrailerSize);
    if (!trailer) return trailer.error();
    const Result<std::uint64_t> at = decode_footer_trailer(*trailer, source.size());
    if (!at) return at.error();
    const Result<Bytes> bytes = read_up_to(source, *at, source.size() - *at);
    if (!bytes) return bytes.error();
    offset = *at;
    return decode_footer(*bytes, *at, job);
}

// The run that begins at `offset` and lies within the file. Errors: kTruncated if it is cut off, others if none begins there.
Result<RunInfo> read_run(const ByteSource& source, std::uint64_t offset, const JobId& job) {
    const Result<Bytes> bytes = read_up_to(source, offset, kRunHeaderSize);
    if (!bytes) return bytes.error();
    const Result<RunHeader> header = decode_run_header(*bytes);
    if (!header) return header.error();
    if (header->job != job) return Error{ErrorCode::kMismatch, "a run of another job"};
    if (header->size() > source.size() - offset) return Error{ErrorCode::kTruncated, "the file ends inside a run"};
    return RunInfo{offset, *header};
}

// The next block at or behind `offset` where a run of this job begins. A run that is cut off ends the search: it reaches the end
// of the file, so nothing but its own bytes can follow.
Result<std::optional<RunInfo>> find_run(const ByteSource& source, std::uint64_t offset, const JobId& job) {
    constexpr std::uint64_t kChunk = 64 * kBlock;
    for (; offset < source.size(); offset += kChunk) {
        const Result<Bytes> chunk = read_up_to(source, offset, kChunk);
        if (!chunk) return chunk.error();
        for (std::uint64_t at = 0; at < chunk->size(); at += kBlock) {
            const Result<RunHeader> header = decode_run_header(ByteSpan(*chunk).subspan(at));
            if (!header || header->job != job) continue;
            if (header->size() > source.size() - offset - at) return std::optional<RunInfo>{};
            return std::optional(RunInfo{offset + at, *header});
        }
    }
    return std::optional<RunInfo>{};
}

// Walks from run to run. After damage it goes on at the next block that begins a run of the job.
Status scan_runs(const ByteSource& source, std::uint64_t begin, FileContents& file) {
    const JobId& job = file.header.job.id;
    file.end = begin;
    while (file.end < source.size()) {
        const Result<RunInfo> here = read_run(source, file.end, job);
        if (here) {
            file.runs.push_back(*here);
            file.end += here->header.size();
            continue;
        }
        if (here.error().code == ErrorCode::kIo) return here.error();
        if (here.error().code == ErrorCode::kTruncated) break;
        const Result<std::optional<RunInfo>> next = find_run(source, file.end + kBlock, job);
        if (!next) return next.error();
        if (!*next) break;
        file.damage.push_back({file.end, (*next)->offset - file.end,
                               fmt::format("bytes {}..{}: {}", file.end, (*next)->offset, here.error().message)});
        file.end = (*next)->offset;
    }
    file.unfinished_tail = source.size() > file.end ? source.size() - file.end : 0;
    return {};
}

// The pages of a run that a level looks at: all, or the last, which a torn write would have missed.
Status verify_pages(const ByteSource& source, const RunIndex& index, const Job& job, VerifyLevel level) {
    Page page;
    const std::size_t first = level == VerifyLevel::kQuick && !index.pages.empty() ? index.pages.size() - 1 : 0;
    for (std::size_t i = first; i < index.pages.size(); ++i) {
        const PageInfo& info = index.pages[i];
        const Result<Bytes> stored = read_up_to(source, info.offset, info.stored_size);
        if (!stored) return stored.error();
        const auto corrupt = [&](std::string_view what) { return Error{ErrorCode::kCorrupt, fmt::format("page {}: {}", i, what)}; };
        if (level != VerifyLevel::kFull) {
            if (hash64(*stored) != info.stored_hash) return corrupt("checksum mismatch");
            continue;
        }
        if (Status s = decode_page(job, info, *stored, ColumnSet{}, page, true); !s) return s.error().at(fmt::format("page {}", i));
        const int shift = 32 - info.node.level;
        for (std::size_t row = 0; row < page.count; ++row) {
            if (shift < 32 && (page.u[row] >> shift != info.node.x || page.v[row] >> shift != info.node.y))
                return corrupt("a record outside its node");
            if (!index.coverage.contains(SampleRange{page.sample[row], page.sample[row] + 1}))
                return corrupt("a record outside the run's coverage");
        }
    }
    return {};
}

std::string lost(const RunInfo& run, const std::string& why) {
    return fmt::format("run at byte {}: {}; samples {}..{} lost", run.offset, why, run.header.samples.first,
                       run.header.samples.end);
}

}  // namespace

Result<RunIndex> read_run_index(const ByteSource& source, const RunInfo& run, const Job& job) {
    const Result<RunInfo> here = read_run(source, run.offset, job.id);
    if (!here && here.error().code == ErrorCode::kIo) return here.error();
    if (!here) return Error{ErrorCode::kCorrupt, "its header is damaged: " + here.error().message};
    if (here->header != run.header) return Error{ErrorCode::kCorrupt, "the run is not the one that the footer lists"};
    const std::uint64_t at = run.header.index_offset();
    const Result<Bytes> bytes = read_up_to(source, run.offset + at, run.header.size() - at);
    if (!bytes) return bytes.error();
    Result<RunIndex> index = decode_run_index(*bytes, run.header, job);
    if (!index) return index;
    for (PageInfo& page : index->pages) page.offset += run.offset;
    return index;
}

Result<Coverage> run_coverage(const ByteSource& source, const RunInfo& run, const Job& job) {
    if (run.header.interval_count == 1) return Coverage(run.header.samples);
    Result<RunIndex> index = read_run_index(source, run, job);
    if (!index) return index.error();
    return std::move(index->coverage);
}

Status verify_run(const ByteSource& source, const RunInfo& run, const Job& job, VerifyLevel level) {
    if (level == VerifyLevel::kHeaders) return {};
    const Result<RunIndex> index = read_run_index(source, run, job);
    if (!index) return index.error();
    return verify_pages(source, *index, job, level);
}

Result<FileContents> read_file(const ByteSource& source, VerifyLevel level, bool use_footer) {
    FileContents file;
    Result<HeaderCopy> header = read_header(source, file.header_damaged);
    if (!header) return header.error();
    file.header = std::move(header->header);
    const Job& job = file.header.job;
    const std::uint64_t begin = 2 * header->size;

    Result<Footer> footer = read_footer(source, begin, job.id, file.end);
    if (!footer && footer.error().code == ErrorCode::kIo) return footer.error();
    file.finished = footer.has_value();
    if (file.finished) file.footer_provenance = std::move(footer->provenance_json);
    if (file.finished && use_footer) {
        file.runs = std::move(footer->runs);
    } else if (Status s = scan_runs(source, begin, file); !s) {
        return s.error();
    }
    if (file.finished) file.unfinished_tail = 0;

    // The last run of an unfinished file may have been written when the power went: its header on disk, its pages not.
    if (!file.finished && !file.runs.empty()) {
        const Status good = verify_run(source, file.runs.back(), job, VerifyLevel::kStored);
        if (!good && good.error().code == ErrorCode::kIo) return good.error();
        if (!good) {
            file.end = file.runs.back().offset;
            file.unfinished_tail = source.size() - file.end;
            file.runs.pop_back();
        }
    }
    std::vector<RunInfo> sound;
    for (const RunInfo& run : file.runs) {
        const Status good = verify_run(source, run, job, level);
        if (!good && good.error().code == ErrorCode::kIo) return good.error();
        if (good) {
            sound.push_back(run);
        } else {
            file.damage.push_back({run.offset, run.header.size(), lost(run, good.error().message)});
        }
    }
    file.runs = std::move(sound);
    return file;
}

Result<FoundFile> open_file(const std::filesystem::path& path, VerifyLevel level, bool use_footer) {
    Result<FileSource> source = FileSource::open(path);
    if (!source) return source.error();
    Result<FileContents> contents = read_file(*source, level, use_footer);
    if (!contents) return contents.error().at(path.string());
    return FoundFile{std::make_shared<const FileSource>(std::move(*source)), std::move(*contents)};
}

Status read_page(const ByteSource& source, const PageInfo& info, const Job& job, const ColumnSet& columns, Page& page) {
    thread_local Bytes stored;
    if (stored.size() < info.stored_size) stored.resize(info.stored_size);
    const std::span<std::byte> bytes = std::span(stored).first(info.stored_size);
    const auto place = [&] { return fmt::format("page at byte {}", info.offset); };
    if (Status s = source.read(info.offset, bytes); !s) return s.error().at(place());
    if (Status s = decode_page(job, info, bytes, columns, page); !s) return s.error().at(place());
    return {};
}

}  // namespace latent::sampledb
