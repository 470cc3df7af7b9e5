#include "sampledb/read/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/hash.h"
#include "base/url.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/z_order.h"
#include "sampledb/format/frames.h"
#include "sampledb/read/footer_reader.h"
#include "sampledb/read/run_walk.h"

namespace latent::sampledb {

namespace {

struct HeaderCopy {
    FileHeader header;
    Bytes bytes;
};

Result<HeaderCopy> read_header_copy(const ByteSource& source, std::uint64_t offset) {
    std::uint64_t size = 0;
    for (std::uint64_t ask = kBlock;; ask = size) {
        Result<Bytes> bytes = read_up_to(source, offset, ask);
        if (!bytes) return bytes.error();
        Result<FileHeader> header = decode_file_header(*bytes, &size);
        if (header) return HeaderCopy{std::move(*header), (bytes->resize(size), std::move(*bytes))};
        if (header.error().code != ErrorCode::kTruncated || size <= ask) return header.error();
    }
}

// The header from its first copy, else from the second, which begins at its own size. `fault`: what is wrong with them.
Result<HeaderCopy> read_header(const ByteSource& source, std::string& fault) {
    if (source.size() == 0) return Error{ErrorCode::kForeign, "empty, not a Latent file"};
    Result<HeaderCopy> first = read_header_copy(source, 0);
    if (first) {
        const Result<HeaderCopy> second = read_header_copy(source, first->bytes.size());
        if (!second && second.error().code == ErrorCode::kIo) return second.error();
        if (!second) fault = "one of its two copies is damaged; the other is used";
        if (second && second->bytes != first->bytes) fault = "its two copies differ; the first is used";
        return first;
    }
    if (first.error().code != ErrorCode::kCorrupt && first.error().code != ErrorCode::kForeign) return first;
    fault = "one of its two copies is damaged; the other is used";
    for (std::uint64_t at = kBlock; at <= kMaxHeaderSize && at < source.size(); at += kBlock) {
        Result<HeaderCopy> second = read_header_copy(source, at);
        if (second ? second->bytes.size() == at : second.error().code == ErrorCode::kIo) return second;
    }
    return first;
}

std::string lost_run(const RunInfo& run, std::string_view why) {
    return fmt::format("run at byte {}: {}; samples {}:{} lost", run.offset, why, run.header.samples.first, run.header.samples.end);
}

// The footer that the file ends with; none if it does not, or if it is damaged. `end`: where it begins, as far as that is known.
Result<std::optional<FooterReader>> find_footer(const ByteSource& source, std::uint64_t begin, std::uint64_t& end) {
    const Result<FooterFrame> found = read_footer_end(source);
    if (!found && found.error().code == ErrorCode::kIo) return found.error();
    if (!found || found->offset < begin) return std::optional<FooterReader>{};
    end = found->offset;
    const Result<FooterReader> footer = FooterReader::open(source, *found);
    if (!footer && footer.error().code == ErrorCode::kIo) return footer.error();
    return footer ? std::optional(*footer) : std::nullopt;
}

// What stands before and behind the runs.
struct Frames {
    FileContents file;
    std::uint64_t begin = 0, end = 0;  // where the runs lie, as far as that is known
    std::optional<FooterReader> footer;

    static Result<Frames> read(const ByteSource& source) {
        Frames frames;
        std::string fault;
        Result<HeaderCopy> header = read_header(source, fault);
        if (!header) return header.error();
        frames.file.header = std::move(header->header);
        if (!fault.empty()) add_damage(frames.file.damage, {0, 0, "header: " + fault, false});
        frames.begin = 2 * header->bytes.size();
        frames.end = source.size();
        Result<std::optional<FooterReader>> footer = find_footer(source, frames.begin, frames.end);
        if (!footer) return footer.error();
        frames.footer = *footer;
        frames.file.finished = frames.footer.has_value();
        if (!frames.footer) return frames;
        Result<std::string> provenance = frames.footer->provenance();
        if (!provenance) return provenance.error();
        frames.file.footer_provenance = std::move(*provenance);
        return frames;
    }
};

// The runs that the footer lists: all, or none if its list is damaged.
Status list_runs(const FooterReader& footer, std::uint64_t begin, FileContents& file) {
    file.runs.reserve(std::min(footer.run_count(), kMaxRunsPerFile));
    const Status listed = footer.for_each_run(begin, file.header.job.id, [&](const RunInfo& run) { file.runs.push_back(run); });
    if (!listed) file.runs = {};
    file.end = footer.offset();
    return listed;
}

// Adds to a file that was walked what its footer lists otherwise. `holes`: between the runs.
Status compare_with_list(const FooterReader& footer, std::uint64_t begin, std::vector<Damage> holes, FileContents& file) {
    std::vector<Damage> missing;
    std::vector<SampleRange> lost;
    auto run = file.runs.begin();
    auto hole = holes.begin();
    const auto omitted = [&](const RunInfo& walked) {
        add_damage(file.damage,
                   {walked.offset, 0, fmt::format("the footer does not list the run at byte {}", walked.offset), false});
    };
    const Status visited = footer.for_each_run(begin, file.header.job.id, [&](const RunInfo& listed) {
        for (; run != file.runs.end() && run->offset < listed.offset; ++run) omitted(*run);
        if (run != file.runs.end() && run->offset == listed.offset) {
            if (run->header != listed.header) {
                add_damage(file.damage,
                           {listed.offset, 0,
                            fmt::format("the footer lists a different header for the run at byte {}", listed.offset), false});
            }
            ++run;
            return;
        }
        add_damage(missing, {listed.offset, listed.header.size(), lost_run(listed, "its header is damaged")});
        lost.push_back(listed.header.samples);
        while (hole != holes.end() && hole->offset + hole->size <= listed.offset) ++hole;
        if (hole != holes.end() && hole->offset <= listed.offset && hole->places == 1) hole->size = 0;  // the list says it better
    });
    if (!visited) return visited;
    for (; run != file.runs.end(); ++run) omitted(*run);
    for (Damage& damage : holes) {
        if (damage.size > 0) add_damage(file.damage, std::move(damage));
    }
    for (Damage& damage : missing) add_damage(file.damage, std::move(damage));
    file.lost_by_list = Coverage::of(std::move(lost));
    return {};
}

// The last run of an unfinished file may have been written when the power went: its header on disk, its pages not.
Status drop_torn_run(const ByteSource& source, FileContents& file) {
    const Status good = verify_run(source, file.runs.back(), file.header.job, VerifyLevel::kStored);
    if (good || good.error().code == ErrorCode::kIo) return good;
    file.end = file.runs.back().offset;
    file.runs.pop_back();
    return {};
}

// Finds the runs without the footer, which is none if it is damaged; then compares.
Status walk(const ByteSource& source, std::uint64_t begin, std::uint64_t end, const FooterReader* footer, FileContents& file) {
    const JobId& job = file.header.job.id;
    Result<RunWalk> walk = walk_runs(source, begin, end, job);
    if (!walk) return walk.error();
    file.runs = std::move(walk->runs);
    file.end = walk->end;
    const Status list = footer != nullptr ? footer->for_each_run(begin, job, [](const RunInfo&) {}) : Status{};
    if (!list && list.error().code == ErrorCode::kIo) return list;
    if (footer != nullptr && list) return compare_with_list(*footer, begin, std::move(walk->damage), file);
    for (Damage& hole : walk->damage) add_damage(file.damage, std::move(hole));
    if (!list && list.error().code != ErrorCode::kUnsupported)  // a run of a later version: the walk has named it
        add_damage(file.damage, {footer->offset(), 0, "the footer does not match the runs: " + list.error().message, false});
    if (footer != nullptr) return {};

    file.footer_begun = walk->footer || end < source.size();
    if (!file.footer_begun && !file.runs.empty()) {
        if (Status s = drop_torn_run(source, file); !s) return s;
    }
    file.unfinished_tail = source.size() - file.end;
    return {};
}

// A page, the `number`th of its run, as the level asks. `coverage`: of its run.
Status verify_page(const ByteSource& source, const PageInfo& info, std::size_t number, const Coverage& coverage, const Job& job,
                   VerifyLevel level, PageDecoder& decoder, Page& page) {
    const Result<Bytes> stored = read_up_to(source, info.offset, info.stored_size);
    if (!stored) return stored.error();
    const auto corrupt = [&](std::string_view what) {
        return Error{ErrorCode::kCorrupt, fmt::format("page {}: {}", number, what)};
    };
    if (level < VerifyLevel::kFull) return hash64(*stored) == info.stored_hash ? Status{} : corrupt("checksum mismatch");
    if (Status s = decoder.decode(job, info, *stored, ColumnSet{}, page, true); !s)
        return s.error().at(fmt::format("page {}", number));
    const int shift = 32 - info.node.level;
    for (std::size_t row = 0; row < page.count; ++row) {
        if (shift < 32 && (page.u[row] >> shift != info.node.x || page.v[row] >> shift != info.node.y))
            return corrupt("a record outside its node");
        if (!coverage.contains(page.sample[row])) return corrupt("a record outside the run's coverage");
    }
    return {};
}

Status verify_order(const ByteSource& source, const RunInfo& run, const Job& job) {
    const Result<RunIndex> index = read_run_index(source, run, job);
    if (!index) return index.error();
    PageDecoder decoder;
    Page page;
    std::uint32_t last = 0;
    for (std::size_t number = 0; number < index->pages.size(); ++number) {
        const PageInfo& info = index->pages[number];
        if (number > 0 && info.record_class != index->pages[number - 1].record_class) last = 0;
        if (Status s = read_page(source, info, job, ColumnSet{}, decoder, page); !s) return s;
        for (std::size_t row = 0; row < page.count; ++row) {
            const std::uint32_t z = z_prefix(page.u[row], page.v[row]);
            if (z < std::exchange(last, z))
                return Error{ErrorCode::kCorrupt, fmt::format("page {}: its records are not in order", number)};
            if (info.part == NodePart::kAnywhere) continue;
            const bool is_lower = (page.v[row] >> (31 - info.node.level) & 1) != 0;
            if (is_lower != (info.part == NodePart::kLower))
                return Error{ErrorCode::kCorrupt, fmt::format("page {}: a record outside its half of a square", number)};
        }
    }
    return {};
}

// Leaves out the runs that fail.
Status verify_runs(const ByteSource& source, VerifyLevel level, FileContents& file) {
    std::size_t sound = 0;
    for (const RunInfo& run : file.runs) {
        const Status good = verify_run(source, run, file.header.job, level);
        if (!good && good.error().code == ErrorCode::kIo) return good;
        if (good) {
            file.runs[sound++] = run;
        } else {
            add_damage(file.damage, {run.offset, run.header.size(), lost_run(run, good.error().message)});
        }
    }
    file.runs.resize(sound);
    return {};
}

}  // namespace

Result<Coverage> scan_run_index(const ByteSource& source, const RunInfo& run, const Job& job,
                                const RunIndexDecoder::TakePage& take) {
    const Result<RunInfo> here = read_run(source, run.offset, job.id);
    if (!here && here.error().code == ErrorCode::kIo) return here.error();
    if (!here) return Error{ErrorCode::kCorrupt, "its header is damaged: " + here.error().message};
    if (here->header != run.header) return Error{ErrorCode::kCorrupt, "the run is not the one that the footer lists"};
    RunIndexDecoder decoder(run.header, job, [&](PageInfo page) {
        page.offset += run.offset;
        return take(page);
    });
    constexpr std::uint64_t kAtOnce = 256 << 10;  // bytes of an index that one read gets whole
    std::uint64_t at = run.offset + run.header.index_offset();
    const std::uint64_t size = run.header.size() - run.header.index_offset();
    Bytes bytes(size <= kAtOnce ? size : 0);
    if (Status s = source.read(at, bytes); !s) return s.error();
    for (std::size_t next = 0, done = 0; (next = decoder.next_size()) > 0; done += next) {
        if (size > kAtOnce) {
            bytes.resize(next);
            if (Status s = source.read(at + done, bytes); !s) return s.error();
        }
        if (Status s = decoder.add(size > kAtOnce ? ByteSpan(bytes) : ByteSpan(bytes).subspan(done, next)); !s) return s.error();
    }
    return decoder.finish();
}

Result<RunIndex> read_run_index(const ByteSource& source, const RunInfo& run, const Job& job) {
    RunIndex index;
    Result<Coverage> coverage = scan_run_index(source, run, job, [&](const PageInfo& page) {
        if (index.pages.empty()) index.pages.reserve(run.header.page_count);
        index.pages.push_back(page);
        return Status{};
    });
    if (!coverage) return coverage.error();
    find_parts(index.pages);
    index.coverage = std::move(*coverage);
    return index;
}

Result<Coverage> run_coverage(const ByteSource& source, const RunInfo& run, const Job& job) {
    if (run.header.interval_count == 1) return Coverage(run.header.samples);
    return scan_run_index(source, run, job, [](const PageInfo&) { return Status{}; });
}

Status verify_run(const ByteSource& source, const RunInfo& run, const Job& job, VerifyLevel level) {
    if (level == VerifyLevel::kHeaders) return {};
    std::optional<PageInfo> last;  // a torn write would have missed it
    const Result<Coverage> coverage = scan_run_index(source, run, job, [&](const PageInfo& info) {
        last = info;
        return Status{};
    });
    if (!coverage) return coverage.error();
    PageDecoder decoder;
    Page page;
    if (!last) return {};
    if (level == VerifyLevel::kQuick)
        return verify_page(source, *last, run.header.page_count - 1, *coverage, job, level, decoder, page);
    std::size_t number = 0;
    const Result<Coverage> again = scan_run_index(source, run, job, [&](const PageInfo& info) {
        return verify_page(source, info, number++, *coverage, job, level, decoder, page);
    });
    if (!again) return again.error();
    return level == VerifyLevel::kOrdered ? verify_order(source, run, job) : Status{};
}

Result<FileContents> read_frames(const ByteSource& source) {
    Result<Frames> frames = Frames::read(source);
    if (!frames) return frames.error();
    return std::move(frames->file);
}

Result<FileContents> read_file(const ByteSource& source, VerifyLevel level, bool use_footer) {
    Result<Frames> frames = Frames::read(source);
    if (!frames) return frames.error();
    FileContents file = std::move(frames->file);
    const FooterReader* const footer = frames->footer ? &*frames->footer : nullptr;
    bool listed = false;
    if (footer != nullptr && use_footer) {
        const Status list = list_runs(*footer, frames->begin, file);
        if (!list && list.error().code == ErrorCode::kIo) return list.error();
        listed = list.has_value();
    }
    if (!listed) {
        if (Status s = walk(source, frames->begin, frames->end, footer, file); !s) return s.error();
    }
    if (Status s = verify_runs(source, level, file); !s) return s.error();
    return file;
}

Result<FoundFile> open_file(const std::filesystem::path& path, VerifyLevel level, bool use_footer) {
    Result<std::shared_ptr<const ByteSource>> source = open_source(path);
    if (!source) return source.error();
    Result<FileContents> contents = read_file(**source, level, use_footer);
    if (!contents) return contents.error().at(shown_name(path));
    return FoundFile{std::move(*source), std::move(*contents)};
}

Status read_page(const ByteSource& source, const PageInfo& info, const Job& job, const ColumnSet& columns, PageDecoder& decoder,
                 Page& page) {
    const std::span<std::byte> stored = decoder.stored(info.stored_size);
    const auto place = [&] { return fmt::format("page at byte {}", info.offset); };
    if (Status s = source.read(info.offset, stored); !s) return s.error().at(place());
    if (Status s = decoder.decode(job, info, stored, columns, page); !s) return s.error().at(place());
    return {};
}

}  // namespace latent::sampledb
