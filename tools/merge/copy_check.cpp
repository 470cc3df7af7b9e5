#include "tools/merge/copy_check.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <mutex>
#include <span>
#include <utility>

#include "base/hash.h"

namespace latent::merge {

using namespace sampledb;

void CopyCheck::expect(const RunInfo& copy, std::uint64_t original, std::shared_ptr<const std::vector<PageInfo>> pages) {
    runs_.push_back({copy, original, std::move(pages)});
}

Status CopyCheck::check(const Task& task, const ByteSource& output) const {
    const Expected& run = runs_[task.run];
    if (task.page == kFrame) {
        if (!run.pages) return verify_run(output, run.copy, job_, level_);
        const Result<Coverage> frame = scan_run_index(output, run.copy, job_, [](const PageInfo&) { return Status{}; });
        return frame ? Status{} : Status(frame.error());
    }
    const PageInfo& page = (*run.pages)[task.page];
    thread_local Bytes buffer;
    if (buffer.size() < page.stored_size) buffer.resize(page.stored_size);
    const std::span<std::byte> bytes = std::span(buffer).first(page.stored_size);
    if (Status s = output.read(page.offset - run.original + run.copy.offset, bytes); !s) return s;
    if (hash64(bytes) == page.stored_hash) return {};
    return Error{ErrorCode::kCorrupt, fmt::format("page {}: checksum mismatch", task.page)};
}

Status CopyCheck::arrived(const ByteSource& output) {
    std::vector<Task> tasks;
    for (std::size_t i = sound_; i < runs_.size() && runs_[i].copy.offset < output.size(); ++i) {
        Expected& run = runs_[i];
        for (; run.pages && run.next < run.pages->size(); ++run.next) {
            const PageInfo& page = (*run.pages)[run.next];
            if (page.offset - run.original + run.copy.offset + page.stored_size > output.size()) break;
            tasks.push_back({i, run.next});
        }
        if (run.end() <= output.size()) tasks.push_back({i, kFrame});
    }
    std::mutex mutex;
    std::size_t first_wrong = tasks.size();
    Status wrong;
    const auto check_task = [&](std::size_t i) {
        const Status good = check(tasks[i], output);
        if (good) return;
        const std::lock_guard lock(mutex);
        if (i < first_wrong) first_wrong = i, wrong = good;
    };
    threads_.run([&] { tbb::parallel_for(std::size_t{0}, tasks.size(), check_task); });
    for (std::size_t i = 0; i < first_wrong; ++i) {
        if (tasks[i].page != kFrame) continue;
        runs_[sound_++].pages.reset();
    }
    return wrong;
}

}  // namespace latent::merge
