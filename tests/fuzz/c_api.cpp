// latent.h, called in any order with any arguments that C allows: pointers are null or good, numbers and handles are anything.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "base/printable.h"
#include "c_api/latent.h"
#include "tests/fuzz/target.h"

namespace latent::fuzz {

namespace {

constexpr std::size_t kRows = 24;  // of each column that is passed

// Numbers that the bytes choose; 0 at their end.
class Choices {
 public:
    explicit Choices(ByteSpan bytes) : bytes_(bytes) {}
    bool done() const { return bytes_.empty(); }
    unsigned byte() {
        if (done()) return 0;
        const auto value = std::to_integer<unsigned>(bytes_[0]);
        bytes_ = bytes_.subspan(1);
        return value;
    }
    bool rarely() { return byte() % 16 == 15; }
    // Mostly `usual`; else what is at the ends of something.
    std::uint64_t number(std::uint64_t usual) {
        constexpr std::array<std::uint64_t, 12> kEnds = {0,    1,        2,      3,          16,         1024,
                                                         2048, 1u << 22, 0xFFFF, 0xFFFFFFFF, 1ull << 63, ~0ull};
        const unsigned b = byte();
        return b % 8 != 7 ? usual : b / 8 < kEnds.size() ? kEnds[b / 8] : byte();
    }
    std::uint32_t small(std::uint32_t usual) { return static_cast<std::uint32_t>(number(usual)); }
    double real(double usual) {
        constexpr std::array kEnds = {0.0, -1.0, 1e308, -1e-308, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL};
        const unsigned b = byte();
        return b % 8 != 7 ? usual : kEnds[b / 8 % kEnds.size()];
    }
    template <class T>
    const T* pointer(const T* good) {
        return rarely() ? nullptr : good;
    }

 private:
    ByteSpan bytes_;
};

class Session {
 public:
    explicit Session(ByteSpan bytes) : choose_(bytes), path_(as_file("c.latent", {}).string()) { std::filesystem::remove(path_); }
    ~Session() {
        for (latent_cursor* cursor : cursors_) latent_cursor_close(cursor);
        for (latent_reader* reader : readers_) latent_reader_close(reader);
        for (latent_writer* writer : writers_) latent_writer_close(writer);
        for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(path_).parent_path())) {
            if (entry.path().filename().string().rfind("c.latent", 0) == 0) std::filesystem::remove(entry.path());
        }
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    // Whether a record was written or read.
    bool run() {
        for (int calls = 0; !choose_.done() && calls < 1000; ++calls) call();
        return worked_;
    }

 private:
    void call() {
        latent_error error{};
        error.status = -1;
        switch (choose_.byte() % 16) {
            case 0:  // nothing: zeros stand between the calls of a seed
                return;
            case 1:
                return checked(open_writer(error), error);
            case 2:
            case 3:
            case 4:
                return checked(submit(error), error);
            case 5:
                return checked(latent_writer_finish(writer(), &error), error);
            case 6:
                return checked(latent_writer_checkpoint(writer(), &error), error);
            case 7: {
                latent_writer_info info{};
                info.size = choose_.number(sizeof info);
                return checked(latent_writer_get_info(writer(), info.size > sizeof info ? nullptr : &info, &error), error);
            }
            case 8:
                if (choose_.rarely()) latent_writer_stop(writer());
                return latent_writer_close(writer());
            case 9:
            case 10:
                return checked(open_reader(error), error);
            case 11:
                return ask_reader(error);
            case 12:
                return checked(open_cursor(error), error);
            case 13:
                return checked(next(error), error);
            case 14:
                choose_.rarely() ? latent_reader_close(reader()) : latent_cursor_close(cursor());
                return;
            default:
                return checked(derive(error), error);
        }
    }

    void checked(latent_status status, const latent_error& error) const {
        require(status >= LATENT_OK && status <= LATENT_NO_MEMORY && error.status == static_cast<std::int32_t>(status), "a status");
        const std::string message = error.message;
        require((status == LATENT_OK) == message.empty() && printable_line(message) == message, "one line for each failure");
    }

    latent_job job() {
        latent_job job{};
        job.size = rare_size(sizeof job);
        job.id_low = choose_.number(1);
        job.aspect_width = choose_.small(3), job.aspect_height = choose_.small(2);
        const bool spectral = choose_.byte() % 2 == 1;
        job.kind = choose_.small(spectral ? LATENT_SPECTRAL : LATENT_XYZ), job.batch = choose_.small(spectral ? 2 : 0);
        job.light_unit = choose_.real(0), job.light_paths_per_sample = choose_.small(1), job.precision = choose_.small(0);
        job.run_samples = choose_.small(1024), job.run_bytes = choose_.number(0);
        job.sampler = choose_.small(LATENT_NO_SAMPLER), job.shift_u = choose_.small(0), job.shift_v = choose_.small(0);
        knots_ = {{0, 400u << 20, 0}, {choose_.number(std::uint64_t{1} << 48), choose_.small(700u << 20), 0}};
        job.knot_count = choose_.byte() % 4 == 3 ? std::min<std::size_t>(choose_.number(2), 2) : 0;
        job.knots = choose_.pointer(knots_.data());
        columns_ = {{choose_.pointer("depth"), choose_.small(LATENT_F32), 0},
                    {choose_.pointer("\xff\n"), choose_.small(LATENT_U8), 0}};
        job.extra_count = choose_.byte() % 4 == 3 ? std::min<std::size_t>(choose_.number(1), 2) : 0;
        job.extra = choose_.pointer(columns_.data());
        return job;
    }
    // Never more than there is.
    std::size_t rare_size(std::size_t size) { return choose_.rarely() ? choose_.byte() % size : size; }
    latent_range range(latent_range usual) { return {choose_.number(usual.first), choose_.number(usual.end)}; }

    latent_status open_writer(latent_error& error) {
        const latent_job its_job = job();
        latent_write_options options{};
        options.size = rare_size(sizeof options);
        options.samples = range({0, 2048});
        if (options.samples.end - options.samples.first > 1u << 20) options.samples.end = options.samples.first;  // grains of days
        options.checkpoint_seconds = choose_.real(1000);
        options.provenance = choose_.pointer(choose_.rarely() ? "[1" : R"({"materials": ["glass", 3]})");
        options.replace = choose_.small(0);
        return latent_writer_open(choose_.pointer(path_.c_str()), choose_.pointer(&its_job), choose_.pointer(&options),
                                  &writers_.emplace_back(), &error);
    }

    latent_status submit(latent_error& error) {
        latent_range grain{0, 0};
        if (!choose_.rarely()) latent_writer_next(writer(), &grain);
        std::array<std::uint64_t, kRows> sample{};
        std::array<std::uint8_t, kRows> record_class{};
        std::array<std::uint32_t, kRows> u{}, xi{};
        std::array<std::uint16_t, kRows> pairs{}, index{};
        std::array<float, kRows> value{}, share{};
        std::array<double, kRows> extra{};
        for (std::size_t i = 0; i < kRows; ++i) {
            sample[i] = grain.first + i, u[i] = static_cast<std::uint32_t>(i << 26), index[i] = 0xFFFF, value[i] = 500,
            share[i] = 1;
            if (choose_.byte() % 8 != 7) continue;
            sample[i] = choose_.number(sample[i]), record_class[i] = static_cast<std::uint8_t>(choose_.byte());
            pairs[i] = static_cast<std::uint16_t>(choose_.byte() % 3), index[i] = static_cast<std::uint16_t>(choose_.small(0xFFFF));
            value[i] = static_cast<float>(choose_.real(1)), share[i] = static_cast<float>(choose_.real(1));
        }
        const std::array<const void*, 2> columns = {choose_.pointer(extra.data()), choose_.pointer(extra.data())};
        latent_records r{};
        r.size = rare_size(sizeof r);
        r.count = kRows - choose_.byte() % (kRows + 1);
        r.sample = choose_.pointer(sample.data()), r.record_class = choose_.pointer(record_class.data());
        r.u = choose_.pointer(u.data()), r.v = choose_.pointer(u.data()), r.share = choose_.pointer(share.data());
        r.x = choose_.pointer(value.data()), r.y = choose_.pointer(value.data()), r.z = choose_.pointer(value.data());
        r.pairs = choose_.pointer(pairs.data()), r.power = choose_.pointer(value.data()),
        r.lambda_nm = choose_.pointer(value.data());
        for (std::size_t i = 0; i < r.count; ++i) r.pair_count += pairs[i];
        if (choose_.rarely()) r.pair_count = choose_.byte() % (kRows + 1);
        if (r.pair_count > kRows) r.pair_count = 0;
        r.xi = choose_.pointer(xi.data()), r.index = choose_.pointer(index.data());
        r.extra = choose_.pointer(columns.data());
        const latent_status status =
            latent_writer_submit(writer(), choose_.rarely() ? range(grain) : grain, choose_.pointer(&r), &error);
        worked_ |= status == LATENT_OK;
        return status;
    }

    latent_status open_reader(latent_error& error) {
        latent_read_options options{};
        options.size = rare_size(sizeof options);
        options.skip_duplicates = choose_.small(0), options.verify = choose_.small(0), options.job_low = choose_.number(0);
        const std::array<const char*, 2> paths = {choose_.pointer(path_.c_str()), "absent\n.latent"};
        return latent_reader_open(choose_.pointer(paths.data()), choose_.rarely() ? choose_.byte() % 3 : 1,
                                  choose_.pointer(&options), &readers_.emplace_back(), &error);
    }

    void ask_reader(latent_error& error) {
        latent_reader* const asked = reader();
        latent_job its_job{};
        its_job.size = rare_size(sizeof its_job);
        checked(latent_reader_job(asked, choose_.pointer(&its_job) != nullptr ? &its_job : nullptr, &error), error);
        latent_reader_info info{};
        info.size = rare_size(sizeof info);
        checked(latent_reader_get_info(asked, &info, &error), error);
        latent_run run{};
        run.size = rare_size(sizeof run);
        checked(latent_reader_run(asked, choose_.number(0), &run, &error), error);
        const char* json = nullptr;
        checked(latent_reader_provenance(asked, &json, &error), error);
        const std::uint64_t i = choose_.number(0);
        for (const char* text :
             {latent_reader_light_group(asked, i), latent_reader_material(asked, i), latent_reader_left_out(asked, i)})
            require(text == nullptr || std::strlen(text) < 10000, "a text that ends");
        latent_range ranges[2];
        (void)latent_reader_coverage(asked, choose_.rarely() ? nullptr : ranges, choose_.byte() % 3);
    }

    latent_status open_cursor(latent_error& error) {
        latent_selection selection{};
        selection.size = rare_size(sizeof selection);
        selection.columns = choose_.small(0), selection.classes = choose_.small(0);
        selection.samples = range({0, 0}), selection.runs = range({0, 0});
        selection.u0 = choose_.real(0), selection.v0 = choose_.real(0), selection.u1 = choose_.real(0),
        selection.v1 = choose_.real(0);
        return latent_cursor_open(reader(), choose_.pointer(&selection), &cursors_.emplace_back(), &error);
    }

    latent_status next(latent_error& error) {
        latent_records r{};
        r.size = rare_size(sizeof r);
        const latent_status status = latent_cursor_next(cursor(), &r, &error);
        if (status != LATENT_OK) return status;
        worked_ |= r.count > 0;
        for (std::size_t i = 0; i < r.count; ++i) {  // every column can be read as far as it goes
            sum_ += r.sample != nullptr ? r.sample[i] : 0;
            sum_ += r.u != nullptr ? r.u[i] + r.v[i] : 0;
            const std::size_t pairs = r.power != nullptr ? r.pairs[i] : 0;
            for (std::size_t p = 0; p < pairs; ++p) require(r.power + r.first_pair[i] + p < r.power + r.pair_count, "pairs within");
        }
        return status;
    }

    latent_status derive(latent_error& error) {
        const latent_job its_job = job();
        std::array<std::uint32_t, kRows> u{}, v{};
        std::array<std::uint64_t, kRows> sample{};
        std::vector<float> lambda(kRows * 1024);
        const std::size_t count = choose_.byte() % (kRows + 1);
        if (choose_.byte() % 2 == 0) {
            return latent_positions(choose_.pointer(&its_job), choose_.pointer(sample.data()), count,
                                    choose_.rarely() ? nullptr : u.data(), v.data(), &error);
        }
        return latent_wavelengths(choose_.pointer(&its_job), choose_.pointer(u.data()), count,
                                  choose_.rarely() ? nullptr : lambda.data(), &error);
    }

    // Mostly the latest; it may be null or closed.
    template <class T>
    T* one_of(const std::vector<T*>& handles) {
        const std::size_t back = choose_.byte() % 8 == 7 ? 2 : 1;
        return back > handles.size() ? nullptr : handles[handles.size() - back];
    }
    latent_writer* writer() { return one_of(writers_); }
    latent_reader* reader() { return one_of(readers_); }
    latent_cursor* cursor() { return one_of(cursors_); }

    Choices choose_;
    const std::string path_;
    std::vector<latent_writer*> writers_;
    std::vector<latent_reader*> readers_;
    std::vector<latent_cursor*> cursors_;
    std::vector<latent_knot> knots_;
    std::vector<latent_column> columns_;
    std::uint64_t sum_ = 0;
    bool worked_ = false;
};

bool run_arguments(ByteSpan bytes) { return Session(bytes).run(); }

// Two parts that are written, finished, read and closed, with the usual numbers.
std::vector<Bytes> argument_seeds() {
    std::vector<Bytes> seeds;
    for (const char spectral : {0, 1}) {
        std::string calls = '\1' + std::string(4, '\0') + spectral + std::string(40, '\0');
        for (const char call : {2, 3, 6, 5, 7, 9, 11, 12, 13, 13, 14, 8, 15}) calls += call + std::string(60, '\0');
        const auto bytes = std::as_bytes(std::span(calls));
        seeds.emplace_back(bytes.begin(), bytes.end());
    }
    return seeds;
}

}  // namespace

Target arguments() { return {"arguments", run_arguments, nullptr, false, 400, argument_seeds}; }

}  // namespace latent::fuzz
