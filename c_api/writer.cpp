// The writing half of latent.h: a PartWriter, its grains, and what callers may get wrong.
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <string_view>

#include "base/json.h"
#include "c_api/abi.h"
#include "c_api/handles.h"
#include "c_api/job.h"
#include "c_api/records.h"
#include "sampledb/codec/record_check.h"
#include "sampledb/data/limits.h"
#include "sampledb/write/grain_queue.h"
#include "sampledb/write/part_writer.h"
#include "sampledb/write/run_assembler.h"

using namespace latent;
using namespace latent::sampledb;

struct latent_writer {
    latent_writer(Job its_job, SampleRange its_range, std::unique_ptr<PartWriter> its_part)
        : job(std::move(its_job)),
          range(its_range),
          part(std::move(its_part)),
          grains(part->missing()),
          expected(part->missing()) {}

    // Takes a grain off the list of those to come. Errors: kUsage (finished), kOutOfRange (not one of them).
    Status expect(SampleRange grain) {
        const std::lock_guard lock(mutex);
        if (finished) return latent::usage_error("the part is finished");
        if (grain.empty() || !expected.contains(grain) || grain != grain_range(grain.first, range)) {
            return Error{ErrorCode::kOutOfRange, "samples " + std::to_string(grain.first) + ":" + std::to_string(grain.end) +
                                                     " are not a grain that is missing; latent_writer_next hands these out"};
        }
        expected.remove(grain);
        return {};
    }
    void expect_again(SampleRange grain) {
        const std::lock_guard lock(mutex);
        expected.add(grain);
    }

    const Job job;
    const SampleRange range;
    const std::unique_ptr<PartWriter> part;
    GrainQueue grains;
    std::mutex mutex;   // guards what follows
    Coverage expected;  // missing, and not submitted
    bool finished = false;
};

namespace {

using Writers = c::Handles<latent_writer>;

Result<PartOptions> part_options(const char* path, const latent_write_options* options) {
    if (path == nullptr) return latent::usage_error("path is null");
    const Result<latent_write_options> given = c::taken(options, sizeof(latent_write_options), "options");
    if (!given) return given.error();
    PartOptions part;
    part.path = path;
    if (part.path.extension() != ".latent") return latent::usage_error(std::string(path) + ": the name does not end in .latent");
    part.range = {given->samples.first, given->samples.end};
    if (part.range.empty()) return latent::usage_error("options.samples is empty");
    if (!std::isfinite(given->checkpoint_seconds) || given->checkpoint_seconds < 0) {
        return Error{ErrorCode::kOutOfRange, "options.checkpoint_seconds is not a positive number"};
    }
    if (given->checkpoint_seconds > 0) part.checkpoint_seconds = given->checkpoint_seconds;
    if (given->provenance != nullptr) {
        part.provenance_json = given->provenance;
        if (part.provenance_json.size() > kMaxProvenanceSize)
            return Error{ErrorCode::kOutOfRange, "options.provenance is above 512 KiB"};
        if (Status s = check_json_object(part.provenance_json, 32); !s) {
            return Error{ErrorCode::kOutOfRange, "options.provenance is not a JSON object: " + s.error().message};
        }
    }
    part.force = given->replace != 0;
    return part;
}

}  // namespace

latent_status latent_writer_open(const char* path, const latent_job* job, const latent_write_options* options,
                                 latent_writer** writer, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (writer == nullptr) return latent::usage_error("writer is null");
        *writer = nullptr;
        Result<Job> made = c::job_from(job);
        if (!made) return made.error();
        const Result<PartOptions> part = part_options(path, options);
        if (!part) return part.error();
        Result<std::unique_ptr<PartWriter>> opened = PartWriter::open(*part, *made);
        if (!opened) return opened.error();
        *writer = Writers::open().add(std::make_shared<latent_writer>(std::move(*made), part->range, std::move(*opened)));
        return {};
    });
}

size_t latent_writer_missing(const latent_writer* writer, latent_range* ranges, size_t capacity) {
    const auto object = Writers::open().look_up(writer);
    if (object == nullptr) return 0;
    const std::span<const SampleRange> missing = object->part->missing().ranges();
    for (size_t i = 0; ranges != nullptr && i < std::min(capacity, missing.size()); ++i)
        ranges[i] = {missing[i].first, missing[i].end};
    return missing.size();
}

int latent_writer_next(latent_writer* writer, latent_range* grain) {
    const auto object = Writers::open().look_up(writer);
    if (object == nullptr || grain == nullptr) return 0;
    const SampleRange next = object->grains.next();
    *grain = {next.first, next.end};
    return next.empty() ? 0 : 1;
}

latent_status latent_writer_submit(latent_writer* writer, latent_range grain, const latent_records* records, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Writers::open().find(writer, "writer");
        if (!object) return object.error();
        const SampleRange range{grain.first, grain.end};
        if (Status s = (*object)->expect(range); !s) return s;
        const auto checked = [&]() -> Result<Records> {
            Result<Records> made = c::records_from((*object)->job, records);
            if (!made) return made;
            if (Status s = check_records((*object)->job, Coverage(range), *made); !s) return s.error();
            return made;
        };
        Result<Records> made = Error{};
        try {
            made = checked();
        } catch (...) {
            made = current_error();
        }
        if (!made) {
            (*object)->expect_again(range);
            return made.error();
        }
        return (*object)->part->submit({range, std::move(*made)});
    });
}

latent_status latent_writer_checkpoint(latent_writer* writer, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Writers::open().find(writer, "writer");
        if (!object) return object.error();
        return (*object)->part->checkpoint();
    });
}

void latent_writer_stop(latent_writer* writer) {
    if (const auto object = Writers::open().look_up(writer)) object->part->give_up();
}

latent_status latent_writer_finish(latent_writer* writer, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Writers::open().find(writer, "writer");
        if (!object) return object.error();
        {
            const std::lock_guard lock((*object)->mutex);
            if ((*object)->finished) return latent::usage_error("the part is finished");
            if (!(*object)->expected.empty() && !(*object)->part->published_elsewhere()) {
                return latent::usage_error("samples " + to_string((*object)->expected) + " were not submitted");
            }
            (*object)->finished = true;
        }
        return (*object)->part->finish();
    });
}

latent_status latent_writer_get_info(const latent_writer* writer, latent_writer_info* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Writers::open().find(writer, "writer");
        if (!object) return object.error();
        const WriterCounts counts = (*object)->part->counts();
        const latent_writer_info value{sizeof value, counts.samples_committed, counts.bytes_written, counts.runs_written,
                                       counts.checkpoints_written};
        return c::give(value, info, sizeof(latent_writer_info), "info");
    });
}

void latent_writer_close(latent_writer* writer) {
    const auto object = Writers::open().take(writer);
    if (object != nullptr && object.use_count() > 1) object->part->give_up();  // others that wait in a call return
}
