// python/reader.h: files as one set of runs, and their records page by page.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "c_api/latent.h"
#include "python/arrays.h"

namespace latent::python {

class Reader {
 public:
    Reader(const std::vector<std::string>& paths, std::optional<JobHalves> job, bool skip_duplicates, bool verify);

    pybind11::dict job() const;
    pybind11::dict info() const;
    pybind11::array coverage() const;
    std::vector<std::string> left_out() const;
    std::string provenance() const;  // JSON
    std::vector<std::string> light_groups() const;
    std::vector<std::string> materials() const;

    // Of all columns; extra ones come last, as extra.NAME where the name is taken.
    const std::vector<std::string>& names() const { return names_; }
    const std::string& extra_name(std::size_t i) const { return names_[own_ + i]; }
    const latent_job& c_job() const { return job_; }
    const latent_reader* get() const { return reader_.get(); }

 private:
    struct Closer {
        void operator()(latent_reader* reader) const { latent_reader_close(reader); }
    };
    std::unique_ptr<latent_reader, Closer> reader_;
    latent_job job_{};
    std::vector<std::string> names_;
    std::size_t own_ = 0;  // of these, the ones that are not extra columns
};

// An iterator over pages: a dict of arrays for each. `columns`: names of the reader.
class Pages {
 public:
    Pages(std::shared_ptr<Reader> reader, std::optional<std::vector<std::string>> columns,
          std::optional<std::vector<double>> region, std::optional<Range> samples, std::uint32_t classes,
          std::optional<Range> runs);

    // Threads that share an iterator take turns.
    pybind11::dict next();

 private:
    bool wants(const std::string& name) const;
    std::uint32_t columns_of_request() const;
    pybind11::dict arrays_of(const latent_records& r) const;

    struct Closer {
        void operator()(latent_cursor* cursor) const { latent_cursor_close(cursor); }
    };
    std::shared_ptr<Reader> reader_;
    std::optional<std::vector<std::string>> wanted_;
    std::mutex mutex_;
    std::unique_ptr<latent_cursor, Closer> cursor_;
};

}  // namespace latent::python
