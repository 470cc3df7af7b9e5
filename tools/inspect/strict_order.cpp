#include "tools/inspect/strict_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "sampledb/codec/run_codec.h"
#include "sampledb/data/z_order.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

std::string to_text(const FilmNode& node) { return fmt::format("{} ({}, {})", node.level, node.x, node.y); }

FilmNode smallest_square(const Page& page) {
    std::uint32_t different = 0;
    for (std::size_t i = 1; i < page.count; ++i) different |= (page.u[i] ^ page.u[0]) | (page.v[i] ^ page.v[0]);
    const int level = std::min<int>(kZPrefixLevels, std::countl_zero(different));
    if (level == 0) return {};
    return {static_cast<std::uint8_t>(level), page.u[0] >> (32 - level), page.v[0] >> (32 - level)};
}

}  // namespace

OrderCheck::OrderCheck(const Job& job, std::size_t number, Violations& violations)
    : page_records_(max_page_records(job)), run_(number), violations_(violations) {}

void OrderCheck::add(const PageInfo& info, std::size_t number, const Page& page) {
    if (info.record_class != record_class_) {
        finish_class();
        record_class_ = info.record_class;
    }
    check_square(info, number, page);
    check_order(number, page);
    cuts_.push_back({number, page.count});
    check_cuts(page_records_);
}

void OrderCheck::finish() { finish_class(); }

void OrderCheck::check_square(const PageInfo& info, std::size_t number, const Page& page) {
    const FilmNode smallest = smallest_square(page);
    if (smallest == info.node) return;
    violations_.add({.run = run_,
                     .page = number,
                     .what = fmt::format("its entry names the square {}", to_text(info.node)),
                     .wanted = fmt::format("{}, the smallest that holds its records", to_text(smallest))});
}

void OrderCheck::check_order(std::size_t number, const Page& page) {
    for (std::size_t row = 0; row < page.count; ++row) {
        const std::uint32_t z = z_prefix(page.u[row], page.v[row]);
        const std::uint64_t sample = page.sample[row];
        if (any_ && (z < last_z_ || (z == last_z_ && sample < last_sample_))) {
            in_order_ = in_order_ && z >= last_z_;
            violations_.add(
                {.run = run_,
                 .page = number,
                 .record = row,
                 .what = fmt::format("Z prefix {:08x}, sample {}", z, sample),
                 .wanted = fmt::format("not before Z prefix {:08x}, sample {}, the previous record", last_z_, last_sample_)});
        }
        any_ = true;
        last_z_ = z;
        last_sample_ = sample;
        z_.push_back(z);
    }
}

// Checks pages while more than `keep` records are at hand: where a page ends shows once the record that is one too many is there.
void OrderCheck::check_cuts(std::size_t keep) {
    std::size_t begin = lead_;
    while (!cuts_.empty() && z_.size() - begin > keep) {
        const Cut cut = cuts_.front();
        cuts_.pop_front();
        const std::size_t wanted = in_order_ ? page_end(z_, begin, page_records_) - begin : cut.records;
        if (wanted != cut.records) {
            violations_.add({.run = run_,
                             .page = cut.page,
                             .what = fmt::format("ends after {} records", cut.records),
                             .wanted = fmt::format("{} records, those of the largest node that begins here and holds at most {}",
                                                   wanted, page_records_)});
        }
        begin += cut.records;
    }
    if (begin <= lead_) return;
    z_.erase(z_.begin(), z_.begin() + static_cast<std::ptrdiff_t>(begin - 1));
    lead_ = 1;
}

void OrderCheck::finish_class() {
    check_cuts(0);
    z_.clear();
    cuts_.clear();
    lead_ = 0;
    any_ = false;
    in_order_ = true;
}

}  // namespace latent::inspect
