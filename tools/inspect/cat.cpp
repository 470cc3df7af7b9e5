#include "tools/inspect/cat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <iterator>
#include <string>

#include "base/bytes.h"
#include "base/json.h"
#include "base/printable.h"
#include "tools/inspect/damage.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 16;

// A float in as few digits as bring it back exactly; JSON has no NaN or infinity: they become null.
template <std::floating_point Float>
void put_value(std::string& line, Float value, bool json) {
    if (json && !std::isfinite(value)) {
        line += "null";
    } else {
        fmt::format_to(std::back_inserter(line), "{}", value);
    }
}

void put_extra(std::string& line, const ExtraColumn& column, std::size_t row, bool json) {
    const std::byte* at = column.values.data() + row * width(column.type);
    switch (column.type) {
        case ColumnType::kU8:
            line += std::to_string(load_le<std::uint8_t>(at));
            break;
        case ColumnType::kU16:
            line += std::to_string(load_le<std::uint16_t>(at));
            break;
        case ColumnType::kU32:
            line += std::to_string(load_le<std::uint32_t>(at));
            break;
        case ColumnType::kU64:
            line += std::to_string(load_le<std::uint64_t>(at));
            break;
        case ColumnType::kF32:
            put_value(line, load_le<float>(at), json);
            break;
        case ColumnType::kF64:
            put_value(line, load_le<double>(at), json);
            break;
    }
}

// A name as a field of CSV [RFC4180], without what would steer a terminal.
std::string csv_field(const std::string& name) {
    const std::string shown = printable_line(name);
    if (shown.find_first_of(",\"") == std::string::npos) return shown;
    std::string field = "\"";
    for (const char c : shown) field += c == '"' ? "\"\"" : std::string(1, c);
    return field + '"';
}

// Lines of text from decoded pages. Columns: sample, class, u, v, share; then x, y, z, or the wavelengths and their values, joined
// by spaces in CSV; then the job's extra columns; one that is named like another is "extra.NAME".
class LineWriter {
 public:
    LineWriter(const Job& job, TextFormat format) : job_(job), json_(format == TextFormat::kJsonLines), lambda_(kMaxPairs) {
        std::vector<std::string> names = {"sample", "class", "u", "v", "share"};
        const std::vector<std::string> values =
            job.kind == RecordKind::kXyz ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"lambda_nm", "power"};
        names.insert(names.end(), values.begin(), values.end());
        const std::size_t own = names.size();
        for (const ExtraColumnSpec& column : job.extra) {
            std::string name = column.name;
            while (std::ranges::find(names, name) != names.end()) name.insert(0, "extra.");
            names.push_back(std::move(name));
        }
        for (std::size_t i = own; i < names.size(); ++i) {
            extra_names_.push_back(json_ ? fmt::format(",{}:", json_text(nlohmann::json(names[i]), -1)) : ",");
        }
        if (json_) return;
        for (const std::string& name : names) heading_ += (heading_.empty() ? "" : ",") + csv_field(name);
        heading_ += '\n';
    }

    const std::string& heading() const { return heading_; }  // empty in JSON

    void put(std::string& line, const Page& page, std::size_t row) {
        const bool camera = page.record_class == RecordClass::kCamera;
        const float share = !camera ? 0.0f : page.unit_share ? 1.0f : page.share[row];
        const char* const name = camera ? "camera" : "light";
        const double u = page.u[row] * 0x1p-32, v = page.v[row] * 0x1p-32;
        if (json_) {
            fmt::format_to(std::back_inserter(line), R"({{"sample":{},"class":"{}","u":{},"v":{},"share":)", page.sample[row], name,
                           u, v);
        } else {
            fmt::format_to(std::back_inserter(line), "{},{},{},{},", page.sample[row], name, u, v);
        }
        put_value(line, share, json_);
        if (job_.kind == RecordKind::kXyz) {
            put_named(line, "x", page.x[row]);
            put_named(line, "y", page.y[row]);
            put_named(line, "z", page.z[row]);
        } else {
            put_pairs(line, page, row);
        }
        for (std::size_t i = 0; i < page.extra.size(); ++i) {
            line += extra_names_[i];
            put_extra(line, page.extra[i], row, json_);
        }
        line += json_ ? "}\n" : "\n";
    }

 private:
    void put_named(std::string& line, const char* name, float value) {
        line += json_ ? fmt::format(",\"{}\":", name) : ",";
        put_value(line, value, json_);
    }
    void put_pairs(std::string& line, const Page& page, std::size_t row) {
        const std::uint16_t n = page.pairs[row];
        const std::span<const float> power(page.power.data() + page.first_pair[row], n);
        std::span<const float> lambda(lambda_.data(), n);
        if (job_.density.empty()) {
            lambda = std::span(page.lambda_nm.data() + page.first_pair[row], n);
        } else if (n == job_.batch) {
            job_.density.batch(page.xi[row], std::span(lambda_).first(n));
        } else if (n == 1) {
            lambda_[0] = job_.density.wavelength(page.xi[row], page.index[row], job_.batch);
        }
        for (const auto& [name, values] : {std::pair("lambda_nm", lambda), std::pair("power", power)}) {
            line += json_ ? fmt::format(",\"{}\":[", name) : ",";
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (i > 0) line += json_ ? ',' : ' ';
                put_value(line, values[i], json_);
            }
            if (json_) line += ']';
        }
    }

    const Job& job_;
    const bool json_;
    std::string heading_;
    std::vector<std::string> extra_names_;  // what stands before the value of each
    std::vector<float> lambda_;
};

// Whether a node has anything in the region.
bool touches(const FilmNode& node, const std::array<double, 4>& region) {
    const double side = std::ldexp(1.0, -node.level);
    return node.x * side < region[2] && (node.x + 1) * side > region[0] && node.y * side < region[3] &&
           (node.y + 1) * side > region[1];
}

}  // namespace

Result<GatherReport> cat(const CatOptions& options, std::FILE* out) {
    GatherOptions gather;
    gather.inputs = options.inputs;
    gather.samples = options.samples;
    gather.job = options.job;
    gather.memory = options.memory;
    const Result<std::unique_ptr<Gathering>> opened = Gathering::open(gather);
    if (!opened) return opened.error();
    const Gathering& gathering = **opened;
    LineWriter lines(gathering.job(), options.format);
    std::string text = lines.heading();
    const auto flush = [&]() -> Status {
        const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size() && std::fflush(out) == 0;
        text.clear();
        if (!written) return error_from_errno(errno, "standard output", "cannot write");
        return {};
    };
    const std::array<double, 4> region = options.region.value_or(std::array<double, 4>{0, 0, 1, 1});
    Page page;
    GatherReport report = gathering.report();
    // Damage costs the page or the run that it is in.
    const auto left_out = [&](std::size_t run, const Error& error) {
        if (!is_unreadable(error)) return false;
        const std::string name = gathering.files()[gathering.runs()[run].file].string();
        leave_out(report.left_out, {name, error.message.substr(name.size() + 2)});
        return true;
    };
    std::uint64_t left = options.limit;
    for (std::size_t run = 0; run < gathering.runs().size() && left > 0; ++run) {
        const auto pages = gathering.pages(run);
        if (!pages) {
            if (left_out(run, pages.error())) continue;
            return pages.error();
        }
        for (const PageInfo& info : **pages) {
            if (left == 0) break;
            if (!touches(info.node, region)) continue;
            if (Status s = gathering.read_page(run, info, ColumnSet{}, page); !s) {
                if (left_out(run, s.error())) continue;
                return s.error();
            }
            for (std::size_t row = 0; row < page.count && left > 0; ++row) {
                const double u = page.u[row] * 0x1p-32, v = page.v[row] * 0x1p-32;
                if (u < region[0] || v < region[1] || u >= region[2] || v >= region[3]) continue;
                lines.put(text, page, row);
                --left;
                if (text.size() < kFlushBytes) continue;
                if (Status s = flush(); !s) return s.error();
            }
        }
    }
    if (Status s = flush(); !s) return s.error();
    return report;
}

}  // namespace latent::inspect
