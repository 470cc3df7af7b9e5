#include "tools/develop/lens/focus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/bytes.h"
#include "base/parse.h"
#include "sampledb/codec/page_decoder.h"
#include "tools/develop/lens/lens_columns.h"

namespace latent::develop {

namespace {

constexpr double kSpot = 1.0 / 128;          // half the side of the square around a pixel, in widths of the film
constexpr std::size_t kEnoughRecords = 256;  // for a median

}  // namespace

Result<Focus> parse_focus(std::string_view text) {
    if (text == "infinity") return Focus{std::numeric_limits<double>::infinity()};
    const bool is_plain = text.find_first_not_of("0123456789.eE+-,") == std::string_view::npos;  // 5m are not five millions
    const auto numbers = is_plain ? parse_numbers(text) : std::nullopt;
    if (numbers && numbers->size() == 1 && (*numbers)[0] > 0) return Focus{(*numbers)[0]};
    const auto is_whole = [](double x) { return x == std::floor(x); };
    if (numbers && numbers->size() == 2 && std::ranges::all_of(*numbers, is_whole))
        return Focus{0, std::array{(*numbers)[0], (*numbers)[1]}};
    return is_not(text, "a distance above 0, or a pixel (try 4.5, infinity, or 120,80)");
}

Result<double> distance_at(const sampledb::RunSet& run_set, const RecordedLens& lens, const std::array<double, 2>& pixel,
                           std::uint32_t width, std::uint32_t height) {
    const std::optional<std::size_t> depth = place_of(run_set.job(), "depth");
    if (!depth || run_set.job().extra[*depth].type != sampledb::ColumnType::kF32)
        return usage_error(
            "--focus: the files do not say how far away pixels are; render the scene again with --aov depth,lens, or give a "
            "distance");
    if (!(pixel[0] >= 0 && pixel[0] < width && pixel[1] >= 0 && pixel[1] < height))
        return usage_error(
            fmt::format("--focus {:g},{:g}: is not inside the picture of {} x {} pixels", pixel[0], pixel[1], width, height));
    const std::array<double, 2> half = {kSpot, kSpot * width / height},
                                at = {(std::floor(pixel[0]) + 0.5) / width, (std::floor(pixel[1]) + 0.5) / height};
    const auto is_near = [&](std::uint32_t position, std::size_t axis) {
        return std::abs(position * 0x1p-32 - at[axis]) <= half[axis];
    };
    const auto reaches = [&](const sampledb::PageInfo& page) {
        const double side = std::ldexp(1.0, -page.node.level);
        const auto along = [&](std::uint32_t node, std::size_t axis) {
            return node * side <= at[axis] + half[axis] && (node + 1) * side >= at[axis] - half[axis];
        };
        return page.record_class == sampledb::RecordClass::kCamera && along(page.node.x, 0) && along(page.node.y, 1);
    };
    const auto columns = lens_columns(run_set.job());
    const sampledb::ColumnSet wanted{
        .values = false, .share = false, .extra = sampledb::ExtraSet().set(*depth).set((*columns)[0]).set((*columns)[1])};
    std::vector<double> distances;
    sampledb::PageDecoder decoder;
    sampledb::Page page;
    for (std::size_t run = 0; run < run_set.runs().size() && distances.size() < kEnoughRecords; ++run) {
        const auto pages = run_set.pages(run);
        if (!pages) return pages.error();
        for (const sampledb::PageInfo& info : **pages) {
            if (!reaches(info)) continue;
            if (Status s = run_set.read_page(run, info, wanted, decoder, page); !s) return s.error();
            for (std::size_t row = 0; row < page.count; ++row) {
                const auto its_depth = static_cast<double>(load_le<float>(page.extra[*depth].values.data() + 4 * row));
                if (!is_near(page.u[row], 0) || !is_near(page.v[row], 1) || !(its_depth > 0)) continue;
                distances.push_back(
                    lens.distance(page.u[row] * 0x1p-32, page.v[row] * 0x1p-32, lens_point(page, *columns, row), its_depth));
            }
        }
    }
    if (distances.empty()) return usage_error("--focus: no record lies near that pixel; give a distance");
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    return *middle;
}

}  // namespace latent::develop
