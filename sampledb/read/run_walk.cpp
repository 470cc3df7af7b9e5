#include "sampledb/read/run_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/size.h"
#include "base/url.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/footer.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

enum class Found {
    kRun,
    kOtherVersion,  // a run that this program cannot read; its length is known
    kCutOff,        // a run that reaches beyond the end
    kFooter,
    kNothing,
};
struct Place {
    Found found = Found::kNothing;
    std::uint64_t offset = 0;
    RunHeader header{};                                    // kRun
    RunFrame frame{};                                      // kOtherVersion
    Error why{ErrorCode::kForeign, "no run begins here"};  // none, or not one that can be read
};

// Bytes of a file on a server that are searched for the next run: it could go on with zeros for ever.
constexpr std::uint64_t kMaxSearched = 256 << 20;

class Walker {
 public:
    Walker(const ByteSource& source, std::uint64_t end, const JobId& job) : source_(source), end_(end), job_(job) {}

    Result<RunWalk> walk(std::uint64_t begin) {
        RunWalk walk;
        for (walk.end = begin; walk.end < end_;) {
            const Result<Bytes> bytes = read(walk.end, kRunHeaderSize);
            if (!bytes) return bytes.error();
            Place place = look(walk.end, *bytes);
            if (place.found == Found::kNothing) {
                Result<Place> next = search(walk.end + kBlock);
                if (!next) return next.error();
                const bool more = next->found != Found::kNothing;
                if (!more && end_ == source_.size()) break;  // it may be a write that was cut short
                const std::uint64_t hole_end = more ? next->offset : end_;
                add_damage(walk.damage,
                           {walk.end, hole_end - walk.end, fmt::format("bytes {}..{}: {}", walk.end, hole_end, place.why.message)});
                if (!more) break;
                place = std::move(*next);
            }
            walk.end = place.offset;
            walk.footer = place.found == Found::kFooter;
            if (walk.footer || place.found == Found::kCutOff) break;
            if (walk.runs.size() == kMaxRunsPerFile)
                return Error{ErrorCode::kUnsupported, fmt::format("more than {} runs, the maximum", kMaxRunsPerFile)};
            if (place.found == Found::kRun) {
                walk.runs.push_back({place.offset, place.header});
                walk.end += place.header.size();
            } else {
                add_damage(walk.damage, {place.offset, place.frame.size,
                                         fmt::format("run at byte {}: {}; samples {}:{} were ignored", place.offset,
                                                     place.why.message, place.frame.samples.first, place.frame.samples.end)});
                walk.end += place.frame.size;
            }
        }
        return walk;
    }

    // What begins at `offset`, of which `bytes` are the first kRunHeaderSize or all that are left.
    Place look(std::uint64_t offset, ByteSpan bytes) const {
        Place place{.offset = offset};
        if (begins_footer(bytes, offset)) {
            place.found = Found::kFooter;
            return place;
        }
        const Result<RunFrame> frame = decode_run_frame(bytes);
        if (!frame) {
            place.why = frame.error();
            if (frame.error().code == ErrorCode::kTruncated) place.found = Found::kCutOff;
            return place;
        }
        place.frame = *frame;
        if (frame->job != job_) {
            place.why = {ErrorCode::kMismatch, "a run of another job"};
        } else if (frame->size > end_ - offset) {
            place.why = {ErrorCode::kTruncated, "the file ends inside a run"};
            place.found = end_ == source_.size() ? Found::kCutOff : Found::kNothing;
        } else if (Result<RunHeader> header = decode_run_header(bytes); header) {
            place.found = Found::kRun;
            place.header = *header;
        } else {
            place.why = header.error();
            if (place.why.code == ErrorCode::kUnsupported) place.found = Found::kOtherVersion;
        }
        return place;
    }

 private:
    // The next block at or behind `offset` where a run of this job or a footer begins.
    Result<Place> search(std::uint64_t offset) const {
        constexpr std::uint64_t kChunk = 64 * kBlock;
        const std::uint64_t begin = offset;
        for (; offset < end_; offset += kChunk) {
            if (offset - begin >= kMaxSearched && source_.file() == nullptr) {
                return Error{ErrorCode::kCorrupt,
                             fmt::format("{}: no run begins in the {} after byte {}; download the file to search all of it",
                                         shown_name(source_.name()), format_size(kMaxSearched), begin)};
            }
            offset += (source_.end_of_hole(offset) - offset) / kBlock * kBlock;
            if (offset >= end_) break;
            const Result<Bytes> chunk = read(offset, kChunk);
            if (!chunk) return chunk.error();
            for (std::uint64_t at = 0; at < chunk->size(); at += kBlock) {
                if ((*chunk)[at] != std::byte{kRunMagic.front()}) continue;
                Place place = look(offset + at, ByteSpan(*chunk).subspan(at));
                if (place.found == Found::kNothing) continue;
                if (place.found != Found::kRun) return place;
                const Result<bool> agrees = index_agrees(place);
                if (!agrees) return agrees.error();
                if (*agrees) return place;
            }
        }
        return Place{};
    }

    // Whether the ends of a run's index are those of its coverage: a header that stands where there is no run has none.
    Result<bool> index_agrees(const Place& run) const {
        const std::uint64_t index = run.offset + run.header.index_offset();
        const std::uint64_t last = index + (run.header.interval_count - 1) * kIntervalSize;
        const Result<Bytes> first = read(index, 8), end = read(last + 8, 8);
        if (!first) return first.error();
        if (!end) return end.error();
        return load_le<std::uint64_t>(first->data()) == run.header.samples.first &&
               load_le<std::uint64_t>(end->data()) == run.header.samples.end;
    }

    Result<Bytes> read(std::uint64_t offset, std::uint64_t size) const {
        return read_up_to(source_, offset, std::min(size, end_ - offset));
    }

    const ByteSource& source_;
    const std::uint64_t end_;
    const JobId job_;
};

}  // namespace

Result<RunWalk> walk_runs(const ByteSource& source, std::uint64_t begin, std::uint64_t end, const JobId& job) {
    return Walker(source, end, job).walk(begin);
}

Result<RunInfo> read_run(const ByteSource& source, std::uint64_t offset, const JobId& job) {
    const Result<Bytes> bytes = read_up_to(source, offset, kRunHeaderSize);
    if (!bytes) return bytes.error();
    const Place place = Walker(source, source.size(), job).look(offset, *bytes);
    if (place.found == Found::kRun) return RunInfo{offset, place.header};
    return place.why;
}

Result<Bytes> read_up_to(const ByteSource& source, std::uint64_t offset, std::uint64_t size) {
    const std::uint64_t there = offset < source.size() ? source.size() - offset : 0;
    Bytes bytes(std::min(size, there));
    if (Status s = source.read(offset, bytes); !s) return s.error();
    return bytes;
}

}  // namespace latent::sampledb
