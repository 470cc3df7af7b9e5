// python/module.cpp: latent.h for Python: readers, pages as NumPy arrays, writers. What users see is in latent/__init__.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sampledb/c/latent.h"

namespace py = pybind11;

namespace {

using Range = std::pair<std::uint64_t, std::uint64_t>;

// What `latent.Error` is made of.
struct Failure : std::runtime_error {
    explicit Failure(const latent_error& error) : std::runtime_error(error.message), status(error.status) {}
    int status;
};

void check(latent_status status, const latent_error& error) {
    if (status != LATENT_OK) throw Failure(error);
}

// A new array of `shape`, filled by a copy.
template <class T>
py::array copied(const T* from, std::vector<py::ssize_t> shape) {
    py::array_t<T> array(std::move(shape));
    if (array.size() > 0) std::memcpy(array.mutable_data(), from, static_cast<std::size_t>(array.nbytes()));
    return array;
}

const char* const kTypes[] = {"", "u1", "u2", "u4", "u8", "f4", "f8"};

class Reader : public std::enable_shared_from_this<Reader> {
 public:
    Reader(const std::vector<std::string>& paths, bool skip_duplicates, bool verify) {
        std::vector<const char*> names;
        names.reserve(paths.size());
        for (const std::string& path : paths) names.push_back(path.c_str());
        latent_read_options options{sizeof options, skip_duplicates, verify};
        latent_error error;
        latent_reader* opened = nullptr;
        latent_status status;
        {
            const py::gil_scoped_release release;
            status = latent_reader_open(names.data(), names.size(), &options, &opened, &error);
        }
        check(status, error);
        reader_.reset(opened);
        job_.size = sizeof job_;
        check(latent_reader_job(opened, &job_, &error), error);
        names_ = {"sample", "class", "u", "v", "share"};
        for (const char* name : {"x", "y", "z"}) {
            if (job_.kind == LATENT_XYZ) names_.emplace_back(name);
        }
        for (const char* name : {"power", "wavelengths"}) {
            if (job_.kind == LATENT_SPECTRAL) names_.emplace_back(name);
        }
        own_ = names_.size();
        for (std::size_t i = 0; i < job_.extra_count; ++i) {
            std::string name = text(job_.extra[i].name);
            while (std::find(names_.begin(), names_.end(), name) != names_.end()) name.insert(0, "extra.");
            names_.push_back(std::move(name));
        }
    }

    py::dict job() const {
        py::dict d;
        char id[33];
        std::snprintf(id, sizeof id, "%016llx%016llx", static_cast<unsigned long long>(job_.id_high),
                      static_cast<unsigned long long>(job_.id_low));
        d["id"] = id;
        d["kind"] = job_.kind == LATENT_XYZ ? "xyz" : "spectral";
        d["aspect"] = py::make_tuple(job_.aspect_width, job_.aspect_height);
        d["wavelengths"] = job_.batch;
        d["stored_wavelengths"] = job_.kind == LATENT_SPECTRAL && job_.knot_count == 0;
        d["light_unit"] = job_.light_unit;
        d["light_paths_per_sample"] = job_.light_paths_per_sample;
        d["precision"] = job_.precision;
        d["run_samples"] = job_.run_samples;
        py::dict extra;
        for (std::size_t i = 0; i < job_.extra_count; ++i) extra[extra_name(i).c_str()] = kTypes[job_.extra[i].type];
        d["extra"] = extra;
        return d;
    }

    py::dict info() const {
        latent_reader_info info{};
        info.size = sizeof info;
        latent_error error;
        check(latent_reader_get_info(reader_.get(), &info, &error), error);
        py::dict d;
        d["files"] = info.files, d["runs"] = info.runs, d["pages"] = info.pages, d["samples"] = info.samples;
        d["camera_records"] = info.camera_records, d["light_records"] = info.light_records, d["pairs"] = info.pairs;
        d["light_paths"] = info.light_paths;
        return d;
    }

    py::array coverage() const {
        std::vector<latent_range> ranges(latent_reader_coverage(reader_.get(), nullptr, 0));
        latent_reader_coverage(reader_.get(), ranges.data(), ranges.size());
        return copied(reinterpret_cast<const std::uint64_t*>(ranges.data()), {static_cast<py::ssize_t>(ranges.size()), 2});
    }

    std::vector<std::string> left_out() const {
        std::vector<std::string> items;
        while (const char* item = latent_reader_left_out(reader_.get(), items.size())) items.emplace_back(item);
        return items;
    }

    // Of all columns; extra ones come last, as extra.NAME where the name is taken.
    const std::vector<std::string>& names() const { return names_; }
    const std::string& extra_name(std::size_t i) const { return names_[own_ + i]; }
    const latent_job& c_job() const { return job_; }
    const latent_reader* get() const { return reader_.get(); }

 private:
    // Names in files need not be UTF-8.
    static std::string text(const char* name) {
        const auto decoded = PyUnicode_DecodeUTF8(name, static_cast<py::ssize_t>(std::strlen(name)), "backslashreplace");
        return py::reinterpret_steal<py::str>(decoded).cast<std::string>();
    }

    struct Closer {
        void operator()(latent_reader* reader) const { latent_reader_close(reader); }
    };
    std::unique_ptr<latent_reader, Closer> reader_;
    latent_job job_{};
    std::vector<std::string> names_;
    std::size_t own_ = 0;  // of these, the ones that are not extra columns
};

// An iterator over pages: a dict of arrays for each.
class Pages {
 public:
    Pages(std::shared_ptr<Reader> reader, std::optional<std::vector<std::string>> columns,
          std::optional<std::vector<double>> region, std::optional<Range> samples, const std::string& classes,
          std::optional<Range> runs)
        : reader_(std::move(reader)), wanted_(std::move(columns)) {
        latent_selection selection{};
        selection.size = sizeof selection;
        selection.columns = columns_of_request();
        selection.classes = classes == "camera" ? 1 : classes == "light" ? 2 : classes == "both" ? 0 : 3;
        if (samples) selection.samples = {samples->first, samples->second};
        if (runs) selection.runs = {runs->first, runs->second};
        if (region) {
            if (region->size() != 4) throw py::value_error("region is (u0, v0, u1, v1)");
            selection.u0 = (*region)[0], selection.v0 = (*region)[1], selection.u1 = (*region)[2], selection.v1 = (*region)[3];
        }
        // What is empty would mean "all" in C.
        const bool nothing = (samples && samples->first >= samples->second) || (runs && runs->first >= runs->second);
        if (nothing) throw py::value_error("samples or runs is empty");
        latent_error error;
        latent_cursor* opened = nullptr;
        check(latent_cursor_open(reader_->get(), &selection, &opened, &error), error);
        cursor_.reset(opened);
    }

    py::dict next() {
        latent_records r{};
        r.size = sizeof r;
        latent_error error;
        latent_status status;
        {
            const py::gil_scoped_release release;
            status = latent_cursor_next(cursor_.get(), &r, &error);
        }
        check(status, error);
        if (r.count == 0) throw py::stop_iteration();
        return arrays_of(r);
    }

 private:
    bool wants(const std::string& name) const {
        return !wanted_ || std::find(wanted_->begin(), wanted_->end(), name) != wanted_->end();
    }

    std::uint32_t columns_of_request() const {
        const latent_job& job = reader_->c_job();
        const std::vector<std::string>& known = reader_->names();
        std::uint32_t columns = 0;
        bool extra = false;
        for (std::size_t i = 0; i < job.extra_count; ++i) extra |= wants(reader_->extra_name(i));
        for (const std::string& name : wanted_.value_or(std::vector<std::string>{})) {
            if (std::find(known.begin(), known.end(), name) == known.end()) throw py::key_error("no column " + name);
        }
        if (wants("sample") || wants("class")) columns |= LATENT_SAMPLES;
        if (wants("u") || wants("v")) columns |= LATENT_POSITIONS;
        if (wants("share")) columns |= LATENT_SHARES;
        if (job.kind == LATENT_XYZ ? wants("x") || wants("y") || wants("z") : wants("power")) columns |= LATENT_VALUES;
        if (job.kind == LATENT_SPECTRAL && wants("wavelengths")) columns |= LATENT_VALUES | LATENT_WAVELENGTHS;
        if (extra) columns |= LATENT_EXTRA;
        if (columns == 0) throw py::value_error("no columns");
        return columns;
    }

    static py::array fraction(const std::uint32_t* from, py::ssize_t n) {
        py::array_t<double> array(n);
        double* to = array.mutable_data();
        for (py::ssize_t i = 0; i < n; ++i) to[i] = from[i] * 0x1p-32;
        return array;
    }

    // Pairs as rows of k; records with fewer end in zeros.
    static py::array rows(const latent_records& r, const float* from, py::ssize_t k) {
        const auto n = static_cast<py::ssize_t>(r.count);
        if (r.pair_count == r.count * static_cast<std::size_t>(k)) return copied(from, {n, k});
        py::array_t<float> array({n, k});
        std::memset(array.mutable_data(), 0, static_cast<std::size_t>(array.nbytes()));
        for (py::ssize_t i = 0; i < n; ++i) std::copy_n(from + r.first_pair[i], r.pairs[i], array.mutable_data() + i * k);
        return array;
    }

    py::dict arrays_of(const latent_records& r) const {
        const latent_job& job = reader_->c_job();
        const auto n = static_cast<py::ssize_t>(r.count);
        py::dict page;
        const auto put = [&](const char* name, const auto* from) {
            if (wants(name)) page[name] = copied(from, {n});
        };
        put("sample", r.sample), put("class", r.record_class);
        if (wants("u")) page["u"] = fraction(r.u, n);
        if (wants("v")) page["v"] = fraction(r.v, n);
        put("share", r.share);
        if (job.kind == LATENT_XYZ) {
            put("x", r.x), put("y", r.y), put("z", r.z);
        } else {
            if (wants("power")) page["power"] = rows(r, r.power, job.batch);
            if (wants("wavelengths")) page["wavelengths"] = rows(r, r.lambda_nm, job.batch);
        }
        for (std::size_t i = 0; i < job.extra_count; ++i) {
            const std::string& name = reader_->extra_name(i);
            if (wants(name))
                page[name.c_str()] = py::array(py::dtype(kTypes[job.extra[i].type]), std::vector<py::ssize_t>{n}, r.extra[i]);
        }
        return page;
    }

    struct Closer {
        void operator()(latent_cursor* cursor) const { latent_cursor_close(cursor); }
    };
    std::shared_ptr<Reader> reader_;
    std::optional<std::vector<std::string>> wanted_;
    std::unique_ptr<latent_cursor, Closer> cursor_;
};

template <class T>
using Column = py::array_t<T, py::array::c_style | py::array::forcecast>;

class Writer {
 public:
    Writer(const std::string& path, const py::dict& given, Range samples, double checkpoint_seconds, const std::string& provenance,
           bool replace) {
        job_.size = sizeof job_;
        job_.id_low = given["id_low"].cast<std::uint64_t>(), job_.id_high = given["id_high"].cast<std::uint64_t>();
        job_.aspect_width = given["aspect_width"].cast<std::uint32_t>(),
        job_.aspect_height = given["aspect_height"].cast<std::uint32_t>();
        job_.kind = given["spectral"].cast<bool>() ? LATENT_SPECTRAL : LATENT_XYZ;
        job_.batch = given["wavelengths"].cast<std::uint32_t>();
        job_.light_unit = given["light_unit"].cast<double>();
        job_.light_paths_per_sample = given["light_paths_per_sample"].cast<std::uint32_t>();
        job_.precision = given["precision"].cast<std::uint32_t>();
        job_.run_samples = given["run_samples"].cast<std::uint32_t>();
        latent_write_options options{};
        options.size = sizeof options;
        options.samples = {samples.first, samples.second};
        options.checkpoint_seconds = checkpoint_seconds;
        options.provenance = provenance.empty() ? nullptr : provenance.c_str();
        options.replace = replace ? 1 : 0;
        latent_error error;
        latent_writer* opened = nullptr;
        latent_status status;
        {
            const py::gil_scoped_release release;
            status = latent_writer_open(path.c_str(), &job_, &options, &opened, &error);
        }
        check(status, error);
        writer_.reset(opened);
    }

    py::array missing() const {
        std::vector<latent_range> ranges(latent_writer_missing(get(), nullptr, 0));
        latent_writer_missing(get(), ranges.data(), ranges.size());
        return copied(reinterpret_cast<const std::uint64_t*>(ranges.data()), {static_cast<py::ssize_t>(ranges.size()), 2});
    }

    std::optional<Range> next() {
        latent_range grain;
        if (latent_writer_next(get(), &grain) == 0) return std::nullopt;
        return Range{grain.first, grain.end};
    }

    void submit(Range grain, const Column<std::uint64_t>& sample, const Column<std::uint32_t>& u, const Column<std::uint32_t>& v,
                const std::vector<Column<float>>& values, const std::optional<Column<float>>& share,
                const std::optional<Column<std::uint8_t>>& record_class) {
        latent_records r{};
        r.size = sizeof r;
        r.count = static_cast<std::size_t>(sample.size());
        const auto fits = [&](const py::array& column, std::size_t width) {
            if (static_cast<std::size_t>(column.size()) != r.count * width) throw py::value_error("columns of different lengths");
        };
        fits(u, 1), fits(v, 1);
        r.sample = sample.data(), r.u = u.data(), r.v = v.data();
        if (share) fits(*share, 1), r.share = share->data();
        if (record_class) fits(*record_class, 1), r.record_class = record_class->data();
        std::vector<std::uint16_t> pairs;
        const bool xyz = job_.kind == LATENT_XYZ;
        if (values.size() != (xyz ? 3 : 2))
            throw py::value_error(xyz ? "x, y and z are needed" : "power and wavelengths are needed");
        for (const Column<float>& column : values) fits(column, xyz ? 1 : job_.batch);
        if (xyz) {
            r.x = values[0].data(), r.y = values[1].data(), r.z = values[2].data();
        } else {
            pairs.assign(r.count, static_cast<std::uint16_t>(job_.batch));
            r.pairs = pairs.data(), r.power = values[0].data(), r.lambda_nm = values[1].data(), r.pair_count = r.count * job_.batch;
        }
        latent_error error;
        latent_status status;
        {
            const py::gil_scoped_release release;
            status = latent_writer_submit(get(), {grain.first, grain.second}, &r, &error);
        }
        check(status, error);
    }

    void checkpoint() { call(latent_writer_checkpoint); }
    void finish() { call(latent_writer_finish); }
    void close() { writer_.reset(); }

 private:
    latent_writer* get() const {
        if (writer_ == nullptr) throw py::value_error("the writer is closed");
        return writer_.get();
    }
    void call(latent_status (*function)(latent_writer*, latent_error*)) {
        latent_writer* const writer = get();
        latent_error error;
        latent_status status;
        {
            const py::gil_scoped_release release;
            status = function(writer, &error);
        }
        check(status, error);
    }

    struct Closer {
        void operator()(latent_writer* writer) const { latent_writer_close(writer); }
    };
    latent_job job_{};
    std::unique_ptr<latent_writer, Closer> writer_;
};

}  // namespace

PYBIND11_MODULE(_latent, m) {
    py::register_exception<Failure>(m, "Error", PyExc_OSError);
    m.def("version", latent_version);
    py::class_<Reader, std::shared_ptr<Reader>>(m, "Reader")
        .def(py::init<const std::vector<std::string>&, bool, bool>())
        .def("job", &Reader::job)
        .def("info", &Reader::info)
        .def("coverage", &Reader::coverage)
        .def("left_out", &Reader::left_out);
    py::class_<Pages>(m, "Pages")
        .def(py::init<std::shared_ptr<Reader>, std::optional<std::vector<std::string>>, std::optional<std::vector<double>>,
                      std::optional<Range>, const std::string&, std::optional<Range>>())
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &Pages::next);
    py::class_<Writer>(m, "Writer")
        .def(py::init<const std::string&, const py::dict&, Range, double, const std::string&, bool>())
        .def("missing", &Writer::missing)
        .def("next", &Writer::next)
        .def("submit", &Writer::submit)
        .def("checkpoint", &Writer::checkpoint)
        .def("finish", &Writer::finish)
        .def("close", &Writer::close);
}
