// docs/format.md keeps its word: its test vectors hold in this library and in the reader in Python.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "base/hash.h"
#include "sampledb/codec/column_decode.h"
#include "sampledb/codec/page_encoder.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/codec/planes.h"
#include "sampledb/codec/rounding.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/pixel_places.h"
#include "sampledb/data/z_order.h"
#include "sampledb/read/selection.h"
#include "tests/faults/process.h"
#include "tests/support/paths.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;

const fs::path kFormat = latent::testing::in_tree("docs/format.md");

template <class T>
T number(const std::string& token, int radix) {
    T value{};
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value, radix);
    EXPECT_TRUE(error == std::errc() && end == token.data() + token.size()) << token;
    return value;
}
template <class T>
std::vector<T> numbers(const std::vector<std::string>& tokens, int radix) {
    std::vector<T> values;
    for (const std::string& token : tokens) values.push_back(number<T>(token, radix));
    return values;
}

// One vector of the page: fields by name, or rows of them.
struct Vector {
    std::map<std::string, std::vector<std::string>> fields;
    std::vector<std::vector<std::string>> rows;

    template <class T>
    std::vector<T> hex(const std::string& key) const {
        return numbers<T>(fields.at(key), 16);
    }
    template <class T>
    T one(const std::string& key, int radix = 10) const {
        return number<T>(fields.at(key).at(0), radix);
    }
    template <class T>
    std::vector<T> decimal(const std::string& key) const {
        return numbers<T>(fields.at(key), 10);
    }
    Bytes bytes(const std::string& key) const {
        Bytes out;
        for (const std::uint8_t byte : hex<std::uint8_t>(key)) out.push_back(static_cast<std::byte>(byte));
        return out;
    }
};

// All vectors, by the name of their block: ```vector NAME. Blank lines part the vectors of a block; a line that begins with a space
// goes on with the one before.
std::multimap<std::string, Vector> vectors_of_the_page() {
    std::multimap<std::string, Vector> vectors;
    std::ifstream page(kFormat);
    const std::string begin = "```vector ";
    std::string name;
    std::vector<std::string> lines;
    const auto finish = [&] {
        Vector vector;
        for (const std::string& line : lines) {
            const std::size_t equals = line.find(" = ");
            std::istringstream words(equals == std::string::npos ? line : line.substr(equals + 3));
            std::vector<std::string> tokens{std::istream_iterator<std::string>(words), {}};
            if (equals != std::string::npos) {
                vector.fields[line.substr(0, equals)] = std::move(tokens);
            } else {
                vector.rows.push_back(std::move(tokens));
            }
        }
        if (!vector.rows.empty()) vector.rows.erase(vector.rows.begin());  // the names of their fields
        if (!lines.empty()) vectors.emplace(name, std::move(vector));
        lines.clear();
    };
    for (std::string line; std::getline(page, line);) {
        if (name.empty()) {
            if (line.starts_with(begin)) name = line.substr(begin.size());
        } else if (line == "```") {
            finish();
            name.clear();
        } else if (line.empty()) {
            finish();
        } else if (line.front() == ' ') {
            lines.back() += line;
        } else {
            lines.push_back(line);
        }
    }
    return vectors;
}

std::uint64_t u64(const std::string& token, int radix) { return number<std::uint64_t>(token, radix); }
std::uint32_t u32(const std::string& token, int radix) { return number<std::uint32_t>(token, radix); }

// Byte i is i mod 251.
Bytes pattern(std::size_t size) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i % 251);
    return bytes;
}

// A column whose planes, "plane 0" and so on, are stored raw, in `bytes`.
ColumnEntry column(const Vector& vector, Transform transform, Bytes& bytes, const std::vector<std::string>& more_planes = {},
                   const std::string& prefix = "") {
    ColumnEntry entry{.column = Column::kSample, .transform = transform};
    std::vector<std::string> keys = more_planes;
    for (int p = 0; p < 8 && vector.fields.contains(prefix + "plane " + std::to_string(p)); ++p)
        keys.push_back(prefix + "plane " + std::to_string(p));
    for (const std::string& key : keys) {
        const Bytes plane = vector.bytes(key);
        bytes.insert(bytes.end(), plane.begin(), plane.end());
        entry.planes.push_back({PlaneCodec::kRaw, static_cast<std::uint32_t>(plane.size())});
    }
    entry.stored = bytes;
    return entry;
}

std::vector<std::uint32_t> bits(std::span<const float> values) {
    std::vector<std::uint32_t> out;
    for (const float value : values) out.push_back(std::bit_cast<std::uint32_t>(value));
    return out;
}

void check_hash(const Vector& vector) {
    for (const auto& row : vector.rows) {
        const Bytes bytes = pattern(u64(row.at(0), 10));
        EXPECT_EQ(hash64(bytes), u64(row.at(1), 16));
        EXPECT_EQ(to_hex(hash128(bytes)), row.at(2));
    }
}

void check_z_prefix(const Vector& vector) {
    for (const auto& row : vector.rows) EXPECT_EQ(z_prefix(u32(row.at(0), 16), u32(row.at(1), 16)), u32(row.at(2), 16));
}

void check_page_cut(const Vector& vector) {
    const auto prefixes = vector.hex<std::uint32_t>("prefixes");
    std::vector<std::size_t> ends;
    for (std::size_t begin = 0; begin < prefixes.size(); begin = ends.back())
        ends.push_back(page_end(prefixes, begin, vector.one<std::size_t>("M")));
    EXPECT_EQ(ends, vector.decimal<std::size_t>("ends"));
}

void check_square(const Vector& vector) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.positions = {};
    Page page;
    page.u = vector.hex<std::uint32_t>("u"), page.v = vector.hex<std::uint32_t>("v");
    page.count = page.u.size();
    page.sample.resize(page.count), page.share.resize(page.count);
    page.x.resize(page.count), page.y.resize(page.count), page.z.resize(page.count);
    Bytes stored;
    const FilmNode node = PageEncoder().encode(job, page, stored).node;
    EXPECT_EQ((std::vector<std::uint32_t>{node.level, node.x, node.y}), vector.decimal<std::uint32_t>("level x y"));
}

void check_planes(const Vector& vector) {
    const std::size_t value_width = vector.fields.at("values").at(0).size() / 2;
    Bytes expected, stored;
    for (const std::uint64_t value : vector.hex<std::uint64_t>("values")) {
        for (std::size_t p = 0; p < value_width; ++p) expected.push_back(static_cast<std::byte>(value >> 8 * p));
    }
    Bytes values(expected.size());
    const ColumnEntry entry = column(vector, Transform::kPlanes, stored);
    ASSERT_TRUE(ColumnDecoder().plain(entry, values, value_width));
    EXPECT_EQ(values, expected);
    Bytes planes(values.size());
    split_planes(values, value_width, planes);
    EXPECT_EQ(planes, stored);
}

void check_packed(const Vector& vector) {
    Bytes stored;
    ColumnEntry entry = column(vector, vector.fields.contains("s") ? Transform::kLattice : Transform::kPacked, stored);
    entry.bits = vector.one<std::uint8_t>("bits");
    entry.base = vector.one<std::uint64_t>("base", 16);
    if (vector.fields.contains("s")) entry.lattice_bits = vector.one<std::uint8_t>("s");
    std::vector<std::uint64_t> values(vector.fields.at("values").size());
    ASSERT_TRUE(ColumnDecoder().samples(entry, values));
    EXPECT_EQ(values, vector.hex<std::uint64_t>("values"));
}

void set_step(const Vector& vector, Transform stepped, ColumnEntry& entry) {
    if (!vector.fields.contains("bits")) return;
    entry.transform = stepped;
    entry.bits = vector.one<std::uint8_t>("bits");
}

void check_cross(const Vector& vector) {
    std::vector<float> y;
    for (const std::uint32_t value : vector.hex<std::uint32_t>("y")) y.push_back(std::bit_cast<float>(value));
    Bytes stored;
    std::vector<float> x(y.size());
    ColumnEntry entry = column(vector, Transform::kCross, stored);
    set_step(vector, Transform::kSteppedCross, entry);
    ASSERT_TRUE(ColumnDecoder().crossed(entry, x, y, {}));
    EXPECT_EQ(bits(x), vector.hex<std::uint32_t>("x"));
}

void check_delta2(const Vector& vector) {
    Bytes stored;
    std::vector<float> values(vector.fields.at("values").size());
    ColumnEntry entry = column(vector, Transform::kDelta2, stored);
    set_step(vector, vector.fields.contains("k") ? Transform::kPackedDelta2 : Transform::kSteppedDelta2, entry);
    const std::size_t k = vector.fields.contains("k") ? vector.one<std::size_t>("k") : 3;
    ASSERT_TRUE(ColumnDecoder().along_records(entry, values, vector.decimal<std::uint16_t>("pairs"), k));
    EXPECT_EQ(bits(values), vector.hex<std::uint32_t>("values"));
}

void check_sparse(const Vector& vector) {
    Bytes stored_x, stored_y;
    std::vector<float> x(vector.fields.at("x").size()), y(x.size());
    BrightRows bright;
    ASSERT_TRUE(ColumnDecoder().luminance(column(vector, Transform::kSparse, stored_y, {"bitmap"}, "y "), y, bright));
    EXPECT_EQ(bits(y), vector.hex<std::uint32_t>("y"));
    ASSERT_TRUE(ColumnDecoder().crossed(column(vector, Transform::kSparseCross, stored_x, {}, "x "), x, y, bright));
    EXPECT_EQ(bits(x), vector.hex<std::uint32_t>("x"));
}

void check_codec(const Vector& vector) {
    const Bytes expected = vector.bytes("plane"), stored = vector.bytes("stored");
    Bytes scratch;
    const PlaneEntry entry{static_cast<PlaneCodec>(vector.one<int>("codec")), static_cast<std::uint32_t>(stored.size())};
    const Result<ByteSpan> plane = PlaneDecoder().decode(entry, stored, expected.size(), scratch);
    ASSERT_TRUE(plane) << plane.error().message;
    EXPECT_TRUE(std::ranges::equal(*plane, expected));
}

void check_halton(const Vector& vector) {
    const PositionSamplerSpec plain{PositionSampler::kHalton23, 0, 0};
    for (const auto& row : vector.rows)
        EXPECT_EQ(halton23(u64(row.at(0), 10), plain), (FilmPosition{u32(row.at(1), 16), u32(row.at(2), 16)}));
}

constexpr PositionSamplerSpec kPixels{PositionSampler::kPixels, 0x12345678, 0x9ABCDEF0, 0, 0};
PositionSamplerSpec pixels_of(PositionSamplerSpec spec, std::uint32_t width, std::uint32_t height) {
    spec.width = width, spec.height = height;
    return spec;
}

void check_pixel_steps(const Vector& vector) {
    for (const auto& row : vector.rows) {
        const std::uint64_t width = u64(row.at(0), 10), height = u64(row.at(1), 10);
        const PixelLattice lattice(
            pixels_of({PositionSampler::kPixels}, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)));
        const auto [x, y, pass] = lattice.place(1);
        const std::uint64_t pixels = width * height, next = 1 % pixels;
        EXPECT_EQ(y * width + x, u64(row.at(2), 10) % pixels);
        EXPECT_EQ(lattice.sample({static_cast<std::uint32_t>(next % width), static_cast<std::uint32_t>(next / width), 0}),
                  u64(row.at(3), 10));
    }
}

void check_pixels(const Vector& vector) {
    for (const auto& row : vector.rows)
        EXPECT_EQ(position_of(u64(row.at(2), 10), pixels_of(kPixels, u32(row.at(0), 10), u32(row.at(1), 10))),
                  (FilmPosition{u32(row.at(3), 16), u32(row.at(4), 16)}));
}

void check_pixels_transform(const Vector& vector) {
    const auto size = vector.decimal<std::uint32_t>("W H"), node = vector.decimal<std::uint32_t>("level x y");
    const auto expected = vector.hex<std::uint64_t>("values");
    const auto bits = vector.one<unsigned>("bits");
    std::vector<std::uint64_t> numbers(expected.size()), values(expected.size());
    unpack_bits(vector.bytes("plane 0"), bits, numbers);
    const auto shifts = vector.hex<std::uint32_t>("shifts");
    PixelPlaces({PositionSampler::kPixels, shifts.at(0), shifts.at(1), size.at(0), size.at(1)},
                {static_cast<std::uint8_t>(node.at(0)), node.at(1), node.at(2)}, vector.one<std::uint64_t>("base", 16))
        .samples(numbers, values);
    EXPECT_EQ(values, expected);
}

void check_points(const Vector& vector) {
    const auto shifts = vector.hex<std::uint32_t>("shifts");
    PositionSamplerSpec spec{PositionSampler::kHalton23, shifts.at(0), shifts.at(1)};
    if (vector.fields.count("W H") > 0) {
        const auto size = vector.decimal<std::uint32_t>("W H");
        spec = {PositionSampler::kPixels, shifts.at(0), shifts.at(1), size.at(0), size.at(1)};
    }
    Bytes points;
    ByteWriter out(points);
    for (std::size_t part = 0; part < vector.fields.at("first").size(); ++part) {
        for (std::uint64_t i = 0; i < vector.decimal<std::uint64_t>("count").at(part); ++i) {
            const std::uint64_t step = vector.hex<std::uint64_t>("step").at(part);
            const FilmPosition at = position_of(vector.decimal<std::uint64_t>("first").at(part) + i * step, spec);
            out.put(at.u);
            out.put(at.v);
        }
    }
    EXPECT_EQ(to_hex(hash128(points)), vector.fields.at("hash128").at(0));
}

WavelengthDensity density_of(const Vector& vector) {
    std::vector<WavelengthDensity::Knot> knots;
    const auto cumulative = vector.hex<std::uint64_t>("cumulative");
    const auto lambda = vector.hex<std::uint32_t>("wavelength");
    for (std::size_t i = 0; i < cumulative.size(); ++i) knots.push_back({lambda.at(i), cumulative[i]});
    return *WavelengthDensity::from_knots(std::move(knots));
}

void check_wavelengths(const Vector& vector) {
    std::vector<float> lambda(vector.one<std::size_t>("k"));
    density_of(vector).batch(vector.one<std::uint32_t>("xi", 16), lambda);
    EXPECT_EQ(bits(lambda), vector.hex<std::uint32_t>("lambda"));
}

void check_wavelength_batches(const Vector& vector) {
    const WavelengthDensity density = density_of(vector);
    std::vector<float> lambda(vector.one<std::size_t>("k"));
    Bytes bytes;
    ByteWriter out(bytes);
    for (std::uint32_t i = 0; i < vector.one<std::uint32_t>("count"); ++i) {
        density.batch(i * vector.one<std::uint32_t>("step", 16), lambda);
        for (const float nm : lambda) out.put(nm);
    }
    EXPECT_EQ(to_hex(hash128(bytes)), vector.fields.at("hash128").at(0));
}

void check_rounding(const Vector& vector) {
    const std::string& id = vector.fields.at("job id").at(0);
    const std::uint64_t seed =
        rounding_seed(rounding_key({u64(id.substr(16), 16), u64(id.substr(0, 16), 16)}), vector.one<std::uint64_t>("n"),
                      vector.one<std::uint32_t>("u", 16), vector.one<std::uint32_t>("v", 16));
    EXPECT_EQ(seed, vector.one<std::uint64_t>("h", 16));
    const auto values = vector.hex<std::uint32_t>("value"), randoms = vector.hex<std::uint32_t>("r");
    for (std::uint32_t i = 0; i < values.size(); ++i) EXPECT_EQ(rounding_random(seed, i), randoms.at(i));
    for (unsigned p = 1; p < 23; ++p) {
        const std::string key = "p " + std::to_string(p);
        if (!vector.fields.contains(key)) continue;
        const auto expected = vector.hex<std::uint32_t>(key);
        for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(rounded(values[i], 23 - p, randoms.at(i)), expected.at(i));
    }
}

// "0..5,7..9#2": intervals of the coverage, and a number for the hashes.
SelectedRun candidate(const std::string& text) {
    SelectedRun run;
    const std::size_t hash = text.find('#');
    std::istringstream intervals(text.substr(0, hash));
    for (std::string interval; std::getline(intervals, interval, ',');) {
        const std::size_t dots = interval.find("..");
        run.coverage.add(SampleRange{u64(interval.substr(0, dots), 10), u64(interval.substr(dots + 2), 10)});
    }
    run.header.samples = {run.coverage.ranges().front().first, run.coverage.ranges().back().end};
    run.header.sample_count = run.coverage.size();
    run.header.content_hash.low = u64(text.substr(hash + 1), 10);
    return run;
}

void check_selection(const Vector& vector) {
    std::vector<SelectedRun> runs;
    for (const std::string& text : vector.fields.at("runs")) runs.push_back(candidate(text));
    std::vector<std::size_t> chosen = select_runs(runs).chosen;
    std::ranges::sort(chosen);
    EXPECT_EQ(chosen, vector.decimal<std::size_t>("chosen"));
}

const std::map<std::string, std::function<void(const Vector&)>> kChecks = {
    {"hash", check_hash},
    {"z-prefix", check_z_prefix},
    {"page-cut", check_page_cut},
    {"square", check_square},
    {"planes", check_planes},
    {"packed", check_packed},
    {"lattice", check_packed},
    {"cross", check_cross},
    {"delta2", check_delta2},
    {"stepped-cross", check_cross},
    {"stepped-delta2", check_delta2},
    {"packed-delta2", check_delta2},
    {"sparse", check_sparse},
    {"codec", check_codec},
    {"halton23", check_halton},
    {"halton23-points", check_points},
    {"pixel-steps", check_pixel_steps},
    {"pixels", check_pixels},
    {"pixels-points", check_points},
    {"pixels-transform", check_pixels_transform},
    {"wavelengths", check_wavelengths},
    {"wavelength-batches", check_wavelength_batches},
    {"rounding", check_rounding},
    {"selection", check_selection},
};

TEST(Specification, EveryTestVectorOfThePageHolds) {
    const std::multimap<std::string, Vector> vectors = vectors_of_the_page();
    for (const auto& [name, check] : kChecks) {
        SCOPED_TRACE(name);
        EXPECT_GT(vectors.count(name), 0u);
    }
    for (const auto& [name, vector] : vectors) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(kChecks.contains(name));
        kChecks.at(name)(vector);
    }
}

TEST(Specification, ItsTestVectorsHoldInTheReaderInPython) {
    const testing::Outcome checked = testing::run_python("tests/sampledb/check_vectors.py", {kFormat.string()});
    EXPECT_EQ(checked.status, 0) << checked.err;
    for (const auto& [name, check] : kChecks) EXPECT_NE(checked.out.find(name + " "), std::string::npos) << name;
}

}  // namespace
}  // namespace latent::sampledb
