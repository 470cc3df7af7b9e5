// A page that was used before, for whatever job, decodes as a new one: nothing of what it held is left.
#include <gtest/gtest.h>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/page_filter.h"
#include "sampledb/read/file_reader.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::make_job;

// A file of one job, its pages at hand.
struct Pages {
    Job job;
    synthetic::FileBytes file;
    MemorySource source;
    std::vector<PageInfo> infos;

    Pages(const Job& of, std::uint64_t samples)
        : job(of),
          file(synthetic::make_file(job, std::vector<Coverage>{Coverage(SampleRange{0, samples})}, true,
                                    {.light_per_sample = 0.3, .split_shares = true})),
          source(file.bytes),
          infos(read_run_index(source, read_file(source)->runs[0], job)->pages) {}
    Pages(const Pages&) = delete;
};

std::vector<Job> jobs() {
    Job explicit_wavelengths = make_job(RecordKind::kSpectral);
    explicit_wavelengths.density = {};
    Job extra = make_job(RecordKind::kXyz), other = extra;
    extra.extra = {{"depth", ColumnType::kF32}, {"group", ColumnType::kU8}};
    other.extra = {{"n", ColumnType::kU64}};
    return {make_job(RecordKind::kSpectral), make_job(RecordKind::kXyz), explicit_wavelengths, extra, other};
}

template <class T>
void expect_same(const std::vector<T>& used, const std::vector<T>& fresh, std::size_t rows, const char* name) {
    ASSERT_EQ(used.empty(), fresh.empty()) << name;
    if (fresh.empty()) return;
    ASSERT_GE(used.size(), rows) << name;
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(used).first(rows)), std::as_bytes(std::span(fresh).first(rows))))
        << name;
}

void expect_same(const Page& used, const Page& fresh) {
    ASSERT_EQ(used.count, fresh.count);
    EXPECT_EQ(used.record_class, fresh.record_class);
    EXPECT_EQ(used.unit_share, fresh.unit_share);
    const std::size_t n = fresh.count;
    expect_same(used.sample, fresh.sample, n, "sample");
    expect_same(used.u, fresh.u, n, "u");
    expect_same(used.v, fresh.v, n, "v");
    expect_same(used.share, fresh.share, n, "share");
    expect_same(used.x, fresh.x, n, "x");
    expect_same(used.y, fresh.y, n, "y");
    expect_same(used.z, fresh.z, n, "z");
    expect_same(used.pairs, fresh.pairs, n, "pairs");
    expect_same(used.first_pair, fresh.first_pair, n + 1, "first_pair");
    expect_same(used.xi, fresh.xi, n, "xi");
    expect_same(used.index, fresh.index, n, "index");
    const std::size_t pairs = fresh.first_pair.empty() ? 0 : fresh.first_pair[n];
    expect_same(used.power, fresh.power, pairs, "power");
    expect_same(used.lambda_nm, fresh.lambda_nm, pairs, "lambda");
    ASSERT_EQ(used.extra.size(), fresh.extra.size());
    for (std::size_t i = 0; i < fresh.extra.size(); ++i) {
        EXPECT_EQ(used.extra[i].name, fresh.extra[i].name);
        EXPECT_EQ(used.extra[i].type, fresh.extra[i].type);
        expect_same(used.extra[i].values, fresh.extra[i].values, n * width(fresh.extra[i].type), "extra");
    }
}

TEST(PageReuse, APageThatWasUsedDecodesAsANewOneWhateverItHeld) {
    const ColumnSet all, values{.samples = true, .positions = false, .share = false, .extra = {}},
        positions{.samples = false, .values = false};
    PageDecoder decoder;
    for (const Job& first : jobs()) {
        for (const Job& second : jobs()) {
            const Pages before(first, 20), after(second, 3000);  // few rows, then more
            for (const ColumnSet& columns : {all, values, positions}) {
                for (const PageInfo& held : before.infos) {
                    Page used;
                    for (const PageInfo& info : after.infos) {
                        Page fresh;
                        ASSERT_TRUE(read_page(before.source, held, first, all, decoder, used));
                        ASSERT_TRUE(read_page(after.source, info, second, columns, decoder, used));
                        PageDecoder new_decoder;
                        ASSERT_TRUE(read_page(after.source, info, second, columns, new_decoder, fresh));
                        expect_same(used, fresh);
                        if (!columns.samples) continue;
                        keep_samples(Coverage(SampleRange{1, 2500}), used);
                        keep_samples(Coverage(SampleRange{1, 2500}), fresh);
                        expect_same(used, fresh);
                    }
                }
            }
        }
    }
}

TEST(PageReuse, APageThatCannotBeDecodedHoldsNothing) {
    Pages pages(make_job(RecordKind::kSpectral), 500);
    PageDecoder decoder;
    Page page;
    for (std::size_t at = 0; at < pages.infos[0].stored_size; at += 37) {
        ASSERT_TRUE(read_page(pages.source, pages.infos[0], pages.job, ColumnSet{}, decoder, page));
        ASSERT_GT(page.count, 0u);
        std::byte& byte = pages.file.bytes[pages.infos[0].offset + at];
        byte ^= std::byte{1};
        EXPECT_FALSE(read_page(pages.source, pages.infos[0], pages.job, ColumnSet{}, decoder, page));
        byte ^= std::byte{1};
        expect_same(page, Page{});
    }
    PageInfo other = pages.infos[0];  // as another job's: a decode that begins, and fails
    const Job xyz = make_job(RecordKind::kXyz);
    ASSERT_TRUE(read_page(pages.source, pages.infos[0], pages.job, ColumnSet{}, decoder, page));
    EXPECT_FALSE(read_page(pages.source, other, xyz, ColumnSet{}, decoder, page));
    expect_same(page, Page{});
}

}  // namespace
}  // namespace latent::sampledb
