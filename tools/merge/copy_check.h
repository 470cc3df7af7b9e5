// tools/merge/copy_check.h: copies of runs are checked as they arrive in the output, before the disk has them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/parallel.h"
#include "base/result.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/file_reader.h"

namespace latent::merge {

// Runs that follow each other in the output, whose bytes arrive from the first to the last.
class CopyCheck {
 public:
    CopyCheck(const sampledb::Job& job, sampledb::VerifyLevel level, const Threads& threads)
        : job_(job), level_(level), threads_(threads) {}

    // The next run; its pages are `pages`, where it begins at `original`. Without pages it is checked once all of it is there.
    void expect(const sampledb::RunInfo& copy, std::uint64_t original,
                std::shared_ptr<const std::vector<sampledb::PageInfo>> pages);

    // Checks what is new; `output` ends where the bytes do that have arrived. After an error no more is checked.
    // Errors: kCorrupt and the like, of the run behind the last that is sound; kIo.
    Status arrived(const sampledb::ByteSource& output);

    std::size_t sound() const { return sound_; }  // runs at the front that are there and as they should be

 private:
    struct Expected {
        sampledb::RunInfo copy;
        std::uint64_t original;
        std::shared_ptr<const std::vector<sampledb::PageInfo>> pages;
        std::size_t next = 0;  // the first page that is not checked
        std::uint64_t end() const { return copy.offset + copy.header.size(); }
    };
    struct Task {
        std::size_t run, page;  // page kFrame: what stands around the pages, or all of the run
    };
    static constexpr std::size_t kFrame = ~std::size_t{0};

    Status check(const Task& task, const sampledb::ByteSource& output) const;

    const sampledb::Job& job_;
    const sampledb::VerifyLevel level_;
    const Threads& threads_;
    std::vector<Expected> runs_;
    std::size_t sound_ = 0;
};

}  // namespace latent::merge
