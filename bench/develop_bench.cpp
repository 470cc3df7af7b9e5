// bench/develop_bench.cpp: developing a file against only reading and decoding the same pages, and one thread against two.
// Usage: develop_bench FILE.latent WIDTH [ROUNDS [MEMORY]]. Each round times every case once, one after another; printed are the
// medians over the rounds (and the smallest) of wall and CPU seconds, records/s, and the ratios. The file should be in the page
// cache: it is read once before. Checked: that all cases decode all records, and that every picture is the same.
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/size.h"
#include "tools/develop/develop.h"

namespace {

using namespace latent;

struct Times {
    std::vector<double> wall, cpu;
};

double cpu_seconds() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

void time(Times& times, const std::function<void()>& work) {
    const double cpu = cpu_seconds();
    const auto begin = std::chrono::steady_clock::now();
    work();
    times.wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    times.cpu.push_back(cpu_seconds() - cpu);
}

[[noreturn]] void give_up(const std::string& why) {
    fmt::print(stderr, "develop_bench: {}\n", why);
    std::exit(1);
}

class HashSink final : public develop::TileSink {
 public:
    Status write(int, int, std::span<const float> pixels) override {
        hasher_.update(std::as_bytes(pixels));
        return {};
    }
    Hash128 digest() const { return hasher_.digest(); }

 private:
    Hasher128 hasher_;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) give_up("usage: develop_bench FILE.latent WIDTH [ROUNDS [MEMORY]]");
    const int rounds = argc > 3 ? std::atoi(argv[3]) : 5;
    sampledb::GatherOptions gather;
    gather.inputs = {argv[1]};
    const auto opened = sampledb::Gathering::open(gather);
    if (!opened) give_up(opened.error().message);
    const sampledb::Gathering& gathering = **opened;
    const sampledb::Job& job = gathering.job();
    const auto channels = develop::Channels::xyz(job, &color::Observer::cie1931());
    develop::Settings settings;
    settings.width = static_cast<std::uint32_t>(std::atoi(argv[2]));
    settings.height = static_cast<std::uint32_t>(std::uint64_t{settings.width} * job.aspect_height / job.aspect_width);
    settings.crop = {0, 0, settings.width, settings.height};
    if (argc > 4) settings.memory = *parse_size(argv[4]);

    std::uint64_t records = 0;
    std::vector<std::pair<std::size_t, sampledb::PageInfo>> pages;
    for (std::size_t run = 0; run < gathering.runs().size(); ++run) {
        records += gathering.runs()[run].header.camera_records + gathering.runs()[run].header.light_records;
        const auto index = gathering.pages(run);
        if (!index) give_up(index.error().message);
        for (const sampledb::PageInfo& page : **index) pages.emplace_back(run, page);
    }
    fmt::print("{}: {} records, {} pages, {} x {} pixels, {:.1f} records per pixel, {} rounds\n", argv[1], records, pages.size(),
               settings.width, settings.height, static_cast<double>(records) / settings.width / settings.height, rounds);

    const auto decode_all = [&](int threads) {
        Threads(threads).run([&] {
            std::atomic<std::uint64_t> decoded = 0;
            tbb::parallel_for(std::size_t{0}, pages.size(), [&](std::size_t i) {
                thread_local sampledb::Page page;
                if (Status s = gathering.read_page(pages[i].first, pages[i].second, channels->columns(), page); !s)
                    give_up(s.error().message);
                decoded += page.count;
            });
            if (decoded != records) give_up("not every record was decoded");
        });
    };
    Hash128 picture;
    const auto develop_all = [&](int threads) {
        HashSink sink;
        Result<develop::DevelopCounts> counts = develop::DevelopCounts{};
        Threads(threads).run([&] { counts = develop::develop(gathering, *channels, settings, sink); });
        if (!counts) give_up(counts.error().message);
        if (picture != Hash128{} && picture != sink.digest()) give_up("two pictures differ");
        picture = sink.digest();
        return *counts;
    };

    decode_all(2);
    const develop::DevelopCounts counts = develop_all(2);
    std::map<std::string, Times> times;
    for (int round = 0; round < rounds; ++round) {
        for (const int threads : {1, 2}) {
            time(times[fmt::format("read and decode, {} thread(s)", threads)], [&] { decode_all(threads); });
            time(times[fmt::format("develop, {} thread(s)", threads)], [&] { develop_all(threads); });
        }
    }
    fmt::print("{:<32}{:>10}{:>10}{:>10}{:>14}\n", "case (medians; smallest CPU)", "wall s", "CPU s", "smallest", "Mrecords/s");
    for (const auto& [name, t] : times) {
        fmt::print("{:<32}{:>10.3f}{:>10.3f}{:>10.3f}{:>14.1f}\n", name, median(t.wall), median(t.cpu),
                   *std::ranges::min_element(t.cpu), static_cast<double>(records) / median(t.wall) * 1e-6);
    }
    const auto ratio = [&](const char* a, const char* b) { return median(times.at(a).wall) / median(times.at(b).wall); };
    fmt::print("speed of developing / of reading and decoding: {:.2f} (1 thread), {:.2f} (2 threads)\n",
               ratio("read and decode, 1 thread(s)", "develop, 1 thread(s)"),
               ratio("read and decode, 2 thread(s)", "develop, 2 thread(s)"));
    fmt::print("2 threads against 1: {:.2f} times as fast; decode factor {:.2f}, {} regions, {} panes\n",
               ratio("develop, 1 thread(s)", "develop, 2 thread(s)"), counts.decode_factor(), counts.regions, counts.panes);
    return 0;
}
