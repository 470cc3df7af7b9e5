#include "python/writer.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "python/failure.h"

namespace py = pybind11;

namespace latent::python {

Writer::Writer(const std::string& path, const py::dict& given, Range samples, double checkpoint_seconds,
               const std::string& provenance, bool replace) {
    job_.size = sizeof job_;
    job_.id_low = get<std::uint64_t>(given, "id_low"), job_.id_high = get<std::uint64_t>(given, "id_high");
    job_.aspect_width = get<std::uint32_t>(given, "aspect_width"), job_.aspect_height = get<std::uint32_t>(given, "aspect_height");
    job_.batch = get<std::uint32_t>(given, "wavelengths");
    job_.kind = job_.batch > 0 ? LATENT_SPECTRAL : LATENT_XYZ;
    job_.light_unit = get<double>(given, "light_unit");
    job_.light_paths_per_sample = get<std::uint32_t>(given, "light_paths_per_sample");
    job_.precision = get<std::uint32_t>(given, "precision");
    job_.run_samples = get<std::uint32_t>(given, "run_samples");
    for (const auto& [name, type] : given["extra"].cast<py::dict>()) {
        const auto known = std::find(std::begin(kTypes), std::end(kTypes), type.cast<std::string>());
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
    return intervals([&](latent_range* ranges, std::size_t n) { return latent_writer_missing(opened(), ranges, n); });
}

std::optional<Range> Writer::next() {
    latent_range grain;
    if (latent_writer_next(opened(), &grain) == 0) return std::nullopt;
    return Range{grain.first, grain.end};
}

void Writer::submit(Range grain, const Column<std::uint64_t>& sample, const Column<std::uint32_t>& u,
                    const Column<std::uint32_t>& v, const std::vector<Column<float>>& values,
                    const std::optional<Column<float>>& share, const std::optional<Column<std::uint8_t>>& record_class,
                    const std::vector<py::array>& extra) {
    latent_records r{};
    r.size = sizeof r;
    r.count = static_cast<std::size_t>(sample.size());
    r.sample = sample.data(), r.u = u.data(), r.v = v.data();
    if (share) r.share = share->data();
    if (record_class) r.record_class = record_class->data();
    std::vector<std::uint16_t> pairs;
    if (job_.kind == LATENT_XYZ) {
        r.x = values[0].data(), r.y = values[1].data(), r.z = values[2].data();
    } else {
        pairs.assign(r.count, static_cast<std::uint16_t>(job_.batch));
        r.pairs = pairs.data(), r.power = values[0].data(), r.lambda_nm = values[1].data(), r.pair_count = r.count * job_.batch;
    }
    std::vector<const void*> extra_data;
    for (const py::array& column : extra) extra_data.push_back(column.data());
    r.extra = extra_data.data();
    latent_writer* const writer = opened();
    latent_error error;
    latent_status status;
    {
        const py::gil_scoped_release release;
        status = latent_writer_submit(writer, {grain.first, grain.second}, &r, &error);
    }
    check(status, error);
}

void Writer::close() {
    std::unique_ptr<latent_writer, Closer> last = std::move(writer_);
    const py::gil_scoped_release release;  // others may wait for it in calls that are about to end
    last.reset();
}

latent_writer* Writer::opened() const {
    if (writer_ == nullptr) throw py::value_error("the writer is closed");
    return writer_.get();
}

void Writer::call(latent_status (*function)(latent_writer*, latent_error*)) {
    latent_writer* const writer = opened();
    latent_error error;
    latent_status status;
    {
        const py::gil_scoped_release release;
        status = function(writer, &error);
    }
    check(status, error);
}

}  // namespace latent::python
