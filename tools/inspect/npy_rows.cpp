#include "tools/inspect/npy_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/printable.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::size_t kHeaderBytes = 8192;  // room for every name and number of rows

// Value `i` of `from`, converted to T, at the same place of each row.
template <class T, class Value>
void scatter(std::byte* to, std::size_t stride, std::size_t rows, const Value& value) {
    for (std::size_t i = 0; i < rows; ++i, to += stride) store_le<T>(to, static_cast<T>(value(i)));
}

void scatter_bytes(std::byte* to, std::size_t stride, std::size_t rows, const std::byte* from, std::size_t width) {
    for (std::size_t i = 0; i < rows; ++i) std::memcpy(to + i * stride, from + i * width, width);
}

std::string quoted(const std::string& name) {
    std::string text = "'";
    for (const char c : printable_line(name)) text += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return text + "'";
}

}  // namespace

std::vector<NpyRows::Field> NpyRows::all_fields(const Job& job) {
    std::vector<Field> fields = {{"sample", "<u8", Source::kSample, 1, 8},
                                 {"class", "|u1", Source::kClass, 1, 1},
                                 {"u", "<f8", Source::kU, 1, 8},
                                 {"v", "<f8", Source::kV, 1, 8},
                                 {"share", "<f4", Source::kShare, 1, 4}};
    if (job.kind == RecordKind::kXyz) {
        fields.insert(fields.end(),
                      {{"x", "<f4", Source::kX, 1, 4}, {"y", "<f4", Source::kY, 1, 4}, {"z", "<f4", Source::kZ, 1, 4}});
    } else {
        fields.insert(fields.end(),
                      {{"lambda_nm", "<f4", Source::kLambda, job.batch, 4}, {"power", "<f4", Source::kPower, job.batch, 4}});
    }
    const char* const types[] = {"", "|u1", "<u2", "<u4", "<u8", "<f4", "<f8"};
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        std::string name = job.extra[i].name;
        while (std::ranges::find(fields, name, &Field::name) != fields.end()) name.insert(0, "extra.");
        fields.push_back(
            {name, types[static_cast<std::size_t>(job.extra[i].type)], Source::kExtra, 1, width(job.extra[i].type), i});
    }
    return fields;
}

Result<NpyRows> NpyRows::of(const Job& job, const std::vector<std::string>& names) {
    const std::vector<Field> all = all_fields(job);
    NpyRows rows(job);
    for (const std::string& name : names) {
        const auto field = std::ranges::find(all, name, &Field::name);
        if (field == all.end() || std::ranges::find(rows.fields_, name, &Field::name) != rows.fields_.end()) {
            std::string known;
            for (const Field& one : all) known += (known.empty() ? "" : ", ") + one.name;
            return usage_error(fmt::format("--columns: '{}' is not a column, or is given twice; choose from {}", name, known));
        }
        rows.fields_.push_back(*field);
    }
    if (names.empty()) rows.fields_ = all;
    for (const Field& field : rows.fields_) {
        rows.row_bytes_ += field.count * field.width;
        const Source s = field.source;
        rows.columns_.samples |= s == Source::kSample;
        rows.columns_.positions |= s == Source::kU || s == Source::kV;
        rows.columns_.share |= s == Source::kShare;
        rows.columns_.values |= s >= Source::kX && s <= Source::kPower;
        if (s == Source::kExtra) rows.columns_.extra.set(field.extra);
    }
    return rows;
}

std::string NpyRows::header(std::uint64_t rows) const {
    std::string text = "{'descr': [";
    for (const Field& field : fields_) {
        text += fmt::format("({}, '{}'{}), ", quoted(field.name), field.type,
                            field.count == 1 && field.source != Source::kPower && field.source != Source::kLambda
                                ? ""
                                : fmt::format(", ({},)", field.count));
    }
    text += fmt::format("], 'fortran_order': False, 'shape': ({},)}}", rows);
    // Version 3.0: names in UTF-8, length in four bytes.
    std::string header("\x93NUMPY\x03\x00", 8);
    const std::uint32_t size = kHeaderBytes - 12;
    std::byte length[4];
    store_le(length, size);
    header.append(reinterpret_cast<const char*>(length), sizeof length);
    header += text;
    header.resize(kHeaderBytes - 1, ' ');
    return header + '\n';
}

void NpyRows::put_pairs(const Field& field, const Page& page, std::size_t rows, std::byte* to) const {
    std::vector<float> lambda(job_->batch);
    for (std::size_t i = 0; i < rows; ++i, to += row_bytes_) {
        const std::uint16_t n = page.pairs[i];
        const float* from = page.power.data() + page.first_pair[i];
        if (field.source == Source::kLambda) {
            wavelengths_of(job_->density, job_->batch, page, i, std::span(lambda).first(n));
            from = lambda.data();
        }
        for (std::size_t p = 0; p < field.count; ++p) store_le(to + p * sizeof(float), p < n ? from[p] : 0.0f);
    }
}

void NpyRows::put(const Field& field, const Page& page, std::size_t rows, std::byte* to) const {
    const auto column = [&](const auto& from) {
        using T = typename std::decay_t<decltype(from)>::value_type;
        scatter<T>(to, row_bytes_, rows, [&](std::size_t i) { return from[i]; });
    };
    switch (field.source) {
        case Source::kSample:
            return column(page.sample);
        case Source::kClass:
            return scatter<std::uint8_t>(to, row_bytes_, rows,
                                         [&](std::size_t) { return static_cast<std::uint8_t>(page.record_class); });
        case Source::kU:
            return scatter<double>(to, row_bytes_, rows, [&](std::size_t i) { return page.u[i] * 0x1p-32; });
        case Source::kV:
            return scatter<double>(to, row_bytes_, rows, [&](std::size_t i) { return page.v[i] * 0x1p-32; });
        case Source::kShare:
            return scatter<float>(to, row_bytes_, rows, [&](std::size_t i) { return share_of(page, i); });
        case Source::kX:
            return column(page.x);
        case Source::kY:
            return column(page.y);
        case Source::kZ:
            return column(page.z);
        case Source::kLambda:
        case Source::kPower:
            return put_pairs(field, page, rows, to);
        case Source::kExtra:
            return scatter_bytes(to, row_bytes_, rows, page.extra[field.extra].values.data(), field.width);
    }
}

ByteSpan NpyRows::encode(const Page& page, std::size_t rows) {
    bytes_.resize(std::max(bytes_.size(), rows * row_bytes_));
    std::byte* to = bytes_.data();
    for (const Field& field : fields_) {
        put(field, page, rows, to);
        to += field.count * field.width;
    }
    return ByteSpan(bytes_).first(rows * row_bytes_);
}

}  // namespace latent::inspect
