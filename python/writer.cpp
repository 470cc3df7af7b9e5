#include "python/writer.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "python/failure.h"

namespace py = pybind11;

namespace latent::python {

namespace {

template <class T>
T field(const py::dict& given, const char* name) {
    try {
        return given[name].cast<T>();
    } catch (const py::cast_error&) {
        throw py::value_error(std::string(name) + ": not a number of its range");
    }
}

}  // namespace

Writer::Writer(const std::string& path, const py::dict& given, Range samples, double checkpoint_seconds,
               const std::string& provenance, bool replace) {
    job_.size = sizeof job_;
    job_.id_low = field<std::uint64_t>(given, "id_low"), job_.id_high = field<std::uint64_t>(given, "id_high");
    job_.aspect_width = field<std::uint32_t>(given, "aspect_width"),
    job_.aspect_height = field<std::uint32_t>(given, "aspect_height");
    job_.kind = field<bool>(given, "spectral") ? LATENT_SPECTRAL : LATENT_XYZ;
    job_.batch = field<std::uint32_t>(given, "wavelengths");
    job_.light_unit = field<double>(given, "light_unit");
    job_.light_paths_per_sample = field<std::uint32_t>(given, "light_paths_per_sample");
    job_.precision = field<std::uint32_t>(given, "precision");
    job_.run_samples = field<std::uint32_t>(given, "run_samples");
    for (const auto& [name, type] : given["extra"].cast<py::dict>()) {
        const auto known = std::find(std::next(std::begin(kTypes)), std::end(kTypes), type.cast<std::string>());
        if (known == std::end(kTypes)) throw py::value_error("the type of an extra column is u1, u2, u4, u8, f4 or f8");
        extra_names_.push_back(name.cast<std::string>());
        extra_.push_back({nullptr, static_cast<std::uint32_t>(known - std::begin(kTypes)), 0});
    }
    for (std::size_t i = 0; i < extra_.size(); ++i) extra_[i].name = extra_names_[i].c_str();
    job_.extra = extra_.data(), job_.extra_count = extra_.size();
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

py::array Writer::missing() const {
    return intervals([&](latent_range* ranges, std::size_t n) { return latent_writer_missing(get(), ranges, n); });
}

std::optional<Range> Writer::next() {
    latent_range grain;
    if (latent_writer_next(get(), &grain) == 0) return std::nullopt;
    return Range{grain.first, grain.end};
}

void Writer::submit(Range grain, const Column<std::uint64_t>& sample, const Column<std::uint32_t>& u,
                    const Column<std::uint32_t>& v, const std::vector<Column<float>>& values,
                    const std::optional<Column<float>>& share, const std::optional<Column<std::uint8_t>>& record_class,
                    const std::vector<py::array>& extra) {
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
    if (values.size() != (xyz ? 3 : 2)) throw py::value_error(xyz ? "x, y and z are needed" : "power and wavelengths are needed");
    for (const Column<float>& column : values) fits(column, xyz ? 1 : job_.batch);
    if (xyz) {
        r.x = values[0].data(), r.y = values[1].data(), r.z = values[2].data();
    } else {
        pairs.assign(r.count, static_cast<std::uint16_t>(job_.batch));
        r.pairs = pairs.data(), r.power = values[0].data(), r.lambda_nm = values[1].data(), r.pair_count = r.count * job_.batch;
    }
    if (extra.size() != extra_.size()) throw py::value_error("extra: the columns of the job are needed");
    std::vector<const void*> extra_data;
    for (std::size_t i = 0; i < extra.size(); ++i) {
        fits(extra[i], 1);
        if (!extra[i].dtype().equal(py::dtype(kTypes[extra_[i].type])))
            throw py::value_error("extra: not of the type of the column");
        extra_data.push_back(extra[i].data());
    }
    r.extra = extra_data.data();
    latent_error error;
    latent_status status;
    {
        const py::gil_scoped_release release;
        status = latent_writer_submit(get(), {grain.first, grain.second}, &r, &error);
    }
    check(status, error);
}

latent_writer* Writer::get() const {
    if (writer_ == nullptr) throw py::value_error("the writer is closed");
    return writer_.get();
}

void Writer::call(latent_status (*function)(latent_writer*, latent_error*)) {
    latent_writer* const writer = get();
    latent_error error;
    latent_status status;
    {
        const py::gil_scoped_release release;
        status = function(writer, &error);
    }
    check(status, error);
}

}  // namespace latent::python
