// tools/inspect/text_rows.h: records as lines of text: CSV, or one JSON object a line.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "tools/inspect/cat.h"

namespace latent::inspect {

// Columns: as in the table, the class behind the sample; in spectral jobs wavelengths and their values, joined by spaces in CSV;
// then the job's extra columns; one that is named like another is "extra.NAME".
class TextRows {
 public:
    // `job` outlives this object.
    TextRows(const sampledb::Job& job, CatFormat format);

    const std::string& heading() const { return heading_; }  // empty in JSON

    // Appends the line of a row.
    void put(std::string& line, const sampledb::Page& page, std::size_t row);

 private:
    void put_class(std::string& line, sampledb::RecordClass record_class) const;
    void put_list(std::string& line, std::span<const float> values) const;
    std::span<const float> wavelengths(const sampledb::Page& page, std::size_t row);

    const sampledb::Job& job_;
    const bool json_;
    std::vector<std::string> names_;
    std::vector<std::string> before_;  // what stands before the value of each
    std::string heading_;
    std::vector<float> lambda_;
};

}  // namespace latent::inspect
