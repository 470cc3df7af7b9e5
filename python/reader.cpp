#include "python/reader.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include "python/failure.h"

namespace py = pybind11;

namespace latent::python {

namespace {

// Names in files need not be UTF-8.
std::string text(const char* name) {
    const auto decoded = PyUnicode_DecodeUTF8(name, static_cast<py::ssize_t>(std::strlen(name)), "backslashreplace");
    return py::reinterpret_steal<py::str>(decoded).cast<std::string>();
}

py::array fraction(const std::uint32_t* from, py::ssize_t n) {
    py::array_t<double> array(n);
    double* to = array.mutable_data();
    for (py::ssize_t i = 0; i < n; ++i) to[i] = from[i] * 0x1p-32;
    return array;
}

// Pairs as rows of k; records with fewer end in zeros.
py::array rows(const latent_records& r, const float* from, py::ssize_t k) {
    const auto n = static_cast<py::ssize_t>(r.count);
    if (r.pair_count == r.count * static_cast<std::size_t>(k)) return copied(from, {n, k});
    py::array_t<float> array({n, k});
    std::memset(array.mutable_data(), 0, static_cast<std::size_t>(array.nbytes()));
    for (py::ssize_t i = 0; i < n; ++i) std::copy_n(from + r.first_pair[i], r.pairs[i], array.mutable_data() + i * k);
    return array;
}

}  // namespace

Reader::Reader(const std::vector<std::string>& paths, std::optional<JobHalves> job, bool skip_duplicates, bool verify) {
    std::vector<const char*> names;
    names.reserve(paths.size());
    for (const std::string& path : paths) names.push_back(path.c_str());
    latent_read_options options{sizeof options, skip_duplicates, verify, 0, 0};
    if (job) options.job_high = job->first, options.job_low = job->second;
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

py::dict Reader::job() const {
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

py::dict Reader::info() const {
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

py::array Reader::coverage() const {
    return intervals([&](latent_range* ranges, std::size_t n) { return latent_reader_coverage(reader_.get(), ranges, n); });
}

std::vector<std::string> Reader::left_out() const {
    std::vector<std::string> items;
    while (const char* item = latent_reader_left_out(reader_.get(), items.size())) items.emplace_back(item);
    return items;
}

std::string Reader::provenance() const {
    const char* json = nullptr;
    latent_error error;
    check(latent_reader_provenance(reader_.get(), &json, &error), error);
    return json;
}

std::vector<std::string> Reader::light_groups() const {
    std::vector<std::string> names;
    while (const char* name = latent_reader_light_group(reader_.get(), names.size())) names.emplace_back(name);
    return names;
}

std::vector<std::string> Reader::materials() const {
    std::vector<std::string> names;
    while (const char* name = latent_reader_material(reader_.get(), names.size() + 1)) names.emplace_back(name);
    return names;
}

Pages::Pages(std::shared_ptr<Reader> reader, std::optional<std::vector<std::string>> columns,
             std::optional<std::vector<double>> region, std::optional<Range> samples, std::uint32_t classes,
             std::optional<Range> runs)
    : reader_(std::move(reader)), wanted_(std::move(columns)) {
    latent_selection selection{};
    selection.size = sizeof selection;
    selection.columns = columns_of_request();
    selection.classes = classes;
    if (samples) selection.samples = {samples->first, samples->second};
    if (runs) selection.runs = {runs->first, runs->second};
    if (region) {
        selection.u0 = (*region)[0], selection.v0 = (*region)[1], selection.u1 = (*region)[2], selection.v1 = (*region)[3];
    }
    latent_error error;
    latent_cursor* opened = nullptr;
    check(latent_cursor_open(reader_->get(), &selection, &opened, &error), error);
    cursor_.reset(opened);
}

py::dict Pages::next() {
    latent_records r{};
    r.size = sizeof r;
    latent_error error;
    latent_status status;
    std::unique_lock<std::mutex> turn(mutex_, std::defer_lock);  // until the columns are copied
    {
        const py::gil_scoped_release release;
        turn.lock();
        status = latent_cursor_next(cursor_.get(), &r, &error);
    }
    check(status, error);
    if (r.count == 0) throw py::stop_iteration();
    return arrays_of(r);
}

bool Pages::wants(const std::string& name) const {
    return !wanted_ || std::find(wanted_->begin(), wanted_->end(), name) != wanted_->end();
}

std::uint32_t Pages::columns_of_request() const {
    const latent_job& job = reader_->c_job();
    std::uint32_t columns = 0;
    bool extra = false;
    for (std::size_t i = 0; i < job.extra_count; ++i) extra |= wants(reader_->extra_name(i));
    if (wants("sample") || wants("class")) columns |= LATENT_SAMPLES;
    if (wants("u") || wants("v")) columns |= LATENT_POSITIONS;
    if (wants("share")) columns |= LATENT_SHARES;
    if (job.kind == LATENT_XYZ ? wants("x") || wants("y") || wants("z") : wants("power")) columns |= LATENT_VALUES;
    if (job.kind == LATENT_SPECTRAL && wants("wavelengths")) columns |= LATENT_VALUES | LATENT_WAVELENGTHS;
    if (extra) columns |= LATENT_EXTRA;
    return columns;
}

py::dict Pages::arrays_of(const latent_records& r) const {
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

}  // namespace latent::python
