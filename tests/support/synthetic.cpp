#include "tests/support/synthetic.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "base/hash.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/footer.h"
#include "sampledb/format/frames.h"
#include "sampledb/format/run_header.h"

namespace latent::synthetic {

using namespace sampledb;

namespace {

// splitmix64: a stream of random numbers named by its seed.
class Random {
 public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        return z ^ z >> 31;
    }
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double exponential() { return -std::log1p(-uniform()); }

 private:
    std::uint64_t state_;
};

[[noreturn]] void give_up(const std::string& why) {
    std::cerr << "synthetic: " << why << std::endl;
    std::abort();
}

WavelengthDensity eye_density() {
    std::vector<WavelengthDensity::Knot> knots;
    const auto primitive = [](double lambda_nm) { return std::tanh(0.0072 * (lambda_nm - 538)); };
    for (std::uint32_t nm = 360; nm <= 830; ++nm) {
        const double q = (primitive(nm) - primitive(360)) / (primitive(830) - primitive(360));
        knots.push_back({nm << 20, static_cast<std::uint64_t>(std::llround(q * 0x1p48))});
    }
    return std::move(*WavelengthDensity::from_knots(std::move(knots)));
}

// Stripes and rings with an edge, 0.05 .. 2: bright at the right, dark at the lower left.
double texture(std::uint32_t u, std::uint32_t v) {
    const double x = u * 0x1p-32, y = v * 0x1p-32;
    const double rings = 1.1 + std::sin(40 * std::hypot(x - 0.3, y - 0.4)) * 0.5 + std::sin(300 * x) * 0.3;
    return (x + y < 0.4 ? 0.25 : 1.0) * rings;
}

class Emitter {
 public:
    Emitter(const Job& job, const Scene& scene, Records& out) : job_(job), scene_(scene), out_(out) {
        for (const ExtraColumnSpec& column : job.extra) out_.extra.push_back({column.name, column.type, {}});
    }

    void sample(std::uint64_t n) {
        Random random(scene_.seed * 0x632BE59BD9B4E019u ^ n);
        FilmPosition at{static_cast<std::uint32_t>(random.bits()), static_cast<std::uint32_t>(random.bits())};
        if (job_.positions.sampler != PositionSampler::kNone) at = position_of(n, job_.positions);
        xi_ = static_cast<std::uint32_t>(random.bits());
        const bool black = random.uniform() < scene_.black;
        const int records = scene_.split_shares && n % 4 == 0 ? 2 : 1;
        for (int i = 0; i < records; ++i) record(n, RecordClass::kCamera, at, 1.0f / static_cast<float>(records), black, random);
        double rest = scene_.light_per_sample;
        for (; rest >= 1 || random.uniform() < rest; rest -= 1) {
            const FilmPosition splat{static_cast<std::uint32_t>(random.bits()), static_cast<std::uint32_t>(random.bits())};
            record(n, RecordClass::kLight, splat, 0, false, random);
            if (rest < 1) break;
        }
    }

 private:
    void record(std::uint64_t n, RecordClass record_class, FilmPosition at, float share, bool black, Random& random) {
        out_.sample.push_back(n);
        out_.record_class.push_back(record_class);
        out_.u.push_back(at.u);
        out_.v.push_back(at.v);
        out_.share.push_back(share);
        const bool uniform = scene_.look == Scene::Look::kUniform;
        const double value = black ? 0 : uniform ? 1 : texture(at.u, at.v) * random.exponential();
        if (job_.kind == RecordKind::kXyz) {
            const double tint = uniform ? 1 : 1 + 0.1 * std::sin(9 * at.u * 0x1p-32) + 0.03 * (random.uniform() - 0.5);
            out_.x.push_back(static_cast<float>(value * tint));
            out_.y.push_back(static_cast<float>(value));
            out_.z.push_back(static_cast<float>(value * (uniform ? 1 : 2.2 - tint + 0.06 * (random.uniform() - 0.5))));
        } else {
            spectrum(value, black, uniform, random);
        }
        for (std::size_t i = 0; i < job_.extra.size(); ++i) {
            for (std::size_t b = 0; b < width(job_.extra[i].type); ++b)
                out_.extra[i].values.push_back(static_cast<std::byte>(random.bits()));
        }
    }

    // A smooth reflectance under the light L = value; now and then a wavelength kept alone.
    void spectrum(double value, bool black, bool uniform, Random& random) {
        const std::uint32_t k = job_.batch;
        const bool alone = !black && !uniform && k > 1 && random.uniform() < 0.02;
        const std::uint32_t kept = static_cast<std::uint32_t>(random.bits() % k);
        const double slope = uniform ? 0 : random.uniform() - 0.5;
        out_.pairs.push_back(static_cast<std::uint16_t>(black ? 0 : alone ? 1 : k));
        for (std::uint32_t i = 0; i < k && !black; ++i) {
            if (alone && i != kept) continue;
            float lambda, pdf;
            if (job_.density.empty()) {
                lambda = 360.0f + 470.0f * (static_cast<float>(i) + static_cast<float>(xi_) * 0x1p-32f) / static_cast<float>(k);
                pdf = 1.0f / 470.0f;
                out_.lambda_nm.push_back(lambda);
            } else {
                lambda = job_.density.wavelength(xi_, i, k);
                pdf = job_.density.pdf_lambda(lambda);
            }
            const double reflected = value * (1 + slope * (static_cast<double>(lambda) - 600) / 300);
            out_.power.push_back(static_cast<float>(reflected / (alone ? 1 : k) / static_cast<double>(pdf)));
        }
        if (job_.density.empty()) return;
        out_.xi.push_back(xi_);
        out_.index.push_back(alone ? static_cast<std::uint16_t>(kept) : kNoIndex);
    }

    const Job& job_;
    const Scene& scene_;
    Records& out_;
    std::uint32_t xi_ = 0;
};

}  // namespace

Job make_job(RecordKind kind, std::uint64_t id) {
    Job job;
    job.id = {id * 0x9E3779B97F4A7C15u, id};
    job.aspect_width = 3;
    job.aspect_height = 2;
    job.kind = kind;
    if (kind == RecordKind::kSpectral) {
        job.batch = 28;
        job.density = eye_density();
    }
    job.light_paths_per_sample = 1;
    job.run_samples = 1u << 14;
    job.positions = {PositionSampler::kHalton23, 0x12345678, 0x9ABCDEF0};
    return job;
}

PositionSamplerSpec pixels_of(std::uint32_t width, std::uint32_t height) {
    return {PositionSampler::kPixels, 0x12345678, 0x9ABCDEF0, width, height};
}

Job make_short_job(RecordKind kind, std::uint64_t id) {
    Job job = make_job(kind, id);
    job.run_samples = static_cast<std::uint32_t>(kShortRun);
    return job;
}

std::vector<Coverage> runs_between(std::initializer_list<std::uint64_t> boundaries) {
    std::vector<Coverage> runs;
    for (const auto* at = boundaries.begin(); at + 1 < boundaries.end(); ++at) runs.emplace_back(SampleRange{at[0], at[1]});
    return runs;
}

Records make_records(const Job& job, SampleRange range, const Scene& scene) {
    Records records;
    Emitter emitter(job, scene, records);
    for (std::uint64_t n = range.first; n < range.end; ++n) emitter.sample(n);
    return records;
}

FileBytes make_file(const Job& job, std::span<const Coverage> runs, bool footer, const Scene& scene,
                    const std::string& provenance_json) {
    FileBytes file;
    Result<Bytes> header = encode_file_header({job, provenance_json});
    if (!header) give_up(header.error().message);
    file.bytes = std::move(*header);
    file.header_size = file.bytes.size();
    std::vector<RunInfo> list;
    for (const Coverage& coverage : runs) {
        Records records;
        Emitter emitter(job, scene, records);
        for (const SampleRange& range : coverage.ranges()) {
            for (std::uint64_t n = range.first; n < range.end; ++n) emitter.sample(n);
        }
        const Result<Bytes> run = encode_run(job, coverage, records);
        if (!run) give_up(run.error().message);
        list.push_back({file.bytes.size(), *decode_run_header(*run)});
        file.bytes.insert(file.bytes.end(), run->begin(), run->end());
        file.run_ends.push_back(file.bytes.size());
    }
    if (footer) {
        const Result<Bytes> end = encode_footer(list, "", file.bytes.size());
        if (!end) give_up(end.error().message);
        file.bytes.insert(file.bytes.end(), end->begin(), end->end());
    }
    return file;
}

std::vector<RunInfo> runs_of(const FileBytes& file) {
    std::vector<RunInfo> runs;
    std::size_t begin = file.header_size;
    for (const std::size_t end : file.run_ends) {
        runs.push_back({begin, *decode_run_header(ByteSpan(file.bytes).subspan(begin))});
        begin = end;
    }
    return runs;
}

Bytes make_first_footer(std::span<const RunInfo> runs, std::uint64_t offset) {
    Bytes bytes;
    ByteWriter out(bytes);
    out.put(bytes_of(kFirstFooterMagic));
    out.put(static_cast<std::uint64_t>(runs.size()));
    out.put(std::uint64_t{0});  // no provenance
    for (const RunInfo& run : runs) {
        out.put(run.offset);
        out.put(encode_run_header(run.header));
    }
    const std::uint64_t size = bytes.size(), hash = hash64(bytes);
    out.put(offset);
    out.put(size + kFooterHeadSize);
    out.put(hash);
    out.put_zeros(24);
    out.put(hash64(ByteSpan(bytes).subspan(size)));
    out.put(bytes_of(kFirstFooterMagic));
    return bytes;
}

Bytes with_transform(const FileBytes& file, std::size_t run, std::uint8_t transform) {
    std::vector<RunInfo> runs = runs_of(file);
    RunHeader& header = runs[run].header;
    Bytes bytes = file.bytes;
    const std::size_t page = runs[run].offset + kRunHeaderSize, index = runs[run].offset + header.index_offset();
    const std::size_t entry = index + header.interval_count * kIntervalSize, end = runs[run].offset + header.size();
    bytes[page + 5] = std::byte{transform};
    const std::uint32_t stored_size = load_le<std::uint32_t>(&bytes[entry + 32]);
    store_le(&bytes[entry + 40], hash64(ByteSpan(bytes).subspan(page, stored_size)));
    header.index_hash = hash64(ByteSpan(bytes).subspan(index, end - index));
    std::ranges::copy(encode_run_header(header), bytes.begin() + static_cast<std::ptrdiff_t>(runs[run].offset));
    const bool finished = bytes.size() > file.run_ends.back();
    bytes.resize(file.run_ends.back());
    const Bytes footer = finished ? *encode_footer(runs, "", bytes.size()) : Bytes();
    bytes.insert(bytes.end(), footer.begin(), footer.end());
    return bytes;
}

void write_file(const std::filesystem::path& path, ByteSpan bytes) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) give_up("cannot write " + path.string());
}

}  // namespace latent::synthetic
