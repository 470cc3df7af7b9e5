// bench/read_pages.cpp: the floor of developing: reads and decodes each page of a file once, with the columns that latent-develop
// needs, and weighs nothing. Usage: read_pages FILE.latent THREADS. Prints how many records it decoded, and checks that these are
// all that the runs promise.
#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/run_set.h"

using namespace latent;

namespace {

int give_up(const std::string& why) {
    fmt::print(stderr, "read_pages: {}\n", why);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return give_up("usage: read_pages FILE.latent THREADS");
    sampledb::RunSetOptions options;
    options.inputs = {argv[1]};
    const auto opened = sampledb::RunSet::open(options);
    if (!opened) return give_up(opened.error().message);
    const sampledb::RunSet& run_set = **opened;

    std::uint64_t promised = 0;
    std::vector<std::pair<std::size_t, sampledb::PageInfo>> pages;
    for (std::size_t run = 0; run < run_set.runs().size(); ++run) {
        promised += run_set.runs()[run].header.camera_records + run_set.runs()[run].header.light_records;
        const auto index = run_set.pages(run);
        if (!index) return give_up(index.error().message);
        for (const sampledb::PageInfo& page : **index) pages.emplace_back(run, page);
    }
    const sampledb::ColumnSet columns{.samples = false, .extra = {}};
    struct Worker {
        sampledb::PageDecoder decoder;
        sampledb::Page page;
    };
    tbb::enumerable_thread_specific<Worker> workers;
    std::atomic<std::uint64_t> decoded = 0, failed = 0;
    Threads(std::atoi(argv[2])).run([&] {
        tbb::parallel_for(std::size_t{0}, pages.size(), [&](std::size_t i) {
            Worker& worker = workers.local();
            if (run_set.read_page(pages[i].first, pages[i].second, columns, worker.decoder, worker.page)) {
                decoded += worker.page.count;
            } else {
                ++failed;
            }
        });
    });
    if (failed > 0 || decoded != promised) return give_up(fmt::format("{} of {} records decoded", decoded.load(), promised));
    fmt::print("{}\n", decoded.load());
    return 0;
}
