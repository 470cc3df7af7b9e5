#include "sampledb/write/earlier_attempts.h"

#include <algorithm>
#include <utility>

#include "sampledb/codec/run_codec.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/part_name.h"

namespace latent::sampledb {

namespace {

bool lies_in_one_interval(SampleRange samples, std::uint64_t run_samples) {
    return !samples.empty() && samples.first / run_samples == (samples.end - 1) / run_samples;
}

// Whether every byte of a run is as it was written.
bool is_sound(const StoredRun& stored, const Job& job) {
    const Result<FileSource> source = FileSource::open(stored.file);
    return source && verify_run(*source, stored.run, job, VerifyLevel::kStored);
}

// Whether a run is no larger in memory than one that a writer of the job would make.
bool is_small(const RunHeader& run, const Job& job) {
    constexpr std::uint64_t kMin = std::uint64_t{32} << 20;  // a single grain may be larger than R
    const std::uint64_t most = std::max(2 * job.run_bytes, kMin);
    return run.size() <= most && run.decoded_size <= most && run.page_count * sizeof(PageInfo) <= most;
}

// The name of an attempt comes before that which it may have got beside: it stays.
std::vector<std::filesystem::path> files_under(const std::filesystem::path& name) {
    std::vector<std::filesystem::path> files = attempts_of(name);
    files.push_back(name);
    return files;
}

Result<DecodedRun> read_run(const StoredRun& stored, const Job& job) {
    const Result<FileSource> source = FileSource::open(stored.file);
    if (!source) return source.error();
    Bytes bytes(stored.run.header.size());
    if (Status s = source->read(stored.run.offset, bytes); !s) return s.error();
    Result<DecodedRun> run = decode_run(job, bytes);
    if (!run) return run.error().at(source->name());
    return run;
}

}  // namespace

std::optional<StoredRun> find_again(const std::filesystem::path& name, const StoredRun& run) {
    for (const std::filesystem::path& path : files_under(name)) {
        const Result<FoundFile> file = open_file(path);
        if (!file) continue;
        const std::vector<RunInfo>& runs = file->contents.runs;
        const auto same = std::ranges::find(runs, run.run.header, &RunInfo::header);
        if (same != runs.end()) return StoredRun{path, *same};
    }
    return std::nullopt;
}

Result<EarlierAttempts> EarlierAttempts::find(const std::filesystem::path& name, const Job& job, SampleRange range) {
    EarlierAttempts earlier;
    earlier.job_ = job;
    earlier.range_ = range;
    for (const std::filesystem::path& path : files_under(name)) {
        const Result<FoundFile> file = open_file(path);
        if (!file) continue;
        if (Status s = check_same_job(*file, job); !s) return s.error();
        for (const RunInfo& run : file->contents.runs) earlier.add({path, run});
    }
    earlier.keep_sound_runs();
    return earlier;
}

// If two runs have the same samples, the one with the smaller content hash counts, as in every selection.
void EarlierAttempts::add(const StoredRun& stored) {
    const SampleRange samples = stored.samples();
    if (!lies_in_one_interval(samples, job_.run_samples) || samples.end <= range_.first || samples.first >= range_.end) return;
    const bool begins_a_grain = samples.first % kGrainSamples == 0 || samples.first == range_.first;
    const bool whole =
        begins_a_grain && samples.end % job_.run_samples == 0 && samples.end <= range_.end && stored.run.header.interval_count == 1;
    StoredRun& known =
        whole ? canonical_.try_emplace(samples.first, stored).first->second : others_.try_emplace(samples, stored).first->second;
    if (stored.run.header.content_hash < known.run.header.content_hash) known = stored;
}

void EarlierAttempts::keep_sound_runs() {
    std::erase_if(canonical_, [&](const auto& entry) {
        const StoredRun& stored = entry.second;
        if (committed_.intersects(stored.samples()) || !is_sound(stored, job_)) return true;
        committed_.add(stored.samples());
        return false;
    });
    std::erase_if(others_, [&](const auto& entry) {
        const auto& [samples, stored] = entry;
        if (committed_.contains(samples) || !is_small(stored.run.header, job_)) return true;
        const Result<DecodedRun> run = read_run(stored, job_);
        if (!run) return true;
        LooseGrains loose{stored, {}};
        Coverage whole;
        for (const GrainPtr& grain : split(run->records, run->coverage, range_)) {
            whole.add(grain->range);
            if (!committed_.contains(grain->range)) loose.grains.add(grain->range);
        }
        loose.with_piece = whole != run->coverage.intersection(Coverage(range_));
        committed_.add(loose.grains);
        if (!loose.grains.empty()) loose_.push_back(std::move(loose));
        return stored.run.header.interval_count != 1;
    });
}

const StoredRun* EarlierAttempts::canonical_at(std::uint64_t sample) const {
    const auto at = canonical_.find(sample);
    return at == canonical_.end() ? nullptr : &at->second;
}

const StoredRun* EarlierAttempts::run_of(SampleRange samples) const {
    const auto at = others_.find(samples);
    return at == others_.end() ? nullptr : &at->second;
}

Result<EarlierAttempts::Taken> EarlierAttempts::take_grain(std::uint64_t sample) {
    if (const auto holder = std::ranges::find_if(loose_,
                                                 [&](const LooseGrains& loose) {
                                                     return loose.grains.intersects({sample, sample + 1});
                                                 });
        holder != loose_.end()) {
        const LooseGrains loose = std::move(*holder);
        loose_.erase(holder);
        const Result<DecodedRun> run = read_run(loose.stored, job_);
        if (!run) return run.error();
        for (GrainPtr& grain : split(run->records, run->coverage, range_)) {
            const std::uint64_t first = grain->range.first;
            if (loose.grains.contains(grain->range)) grains_.emplace(first, Taken{std::move(grain), loose.with_piece});
        }
    }
    const auto at = grains_.find(sample);
    return at == grains_.end() ? Taken{} : std::move(grains_.extract(at).mapped());
}

}  // namespace latent::sampledb
