// tools/inspect/npy_rows.h: records as one structured NumPy array, row after row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::inspect {

// Fields: sample u8, class u1 (0 camera, 1 light), u and v f8 in [0, 1), share f4; then x, y, z f4, or lambda_nm and power as f4
// arrays of k, which end in zeros in records of fewer pairs; then the job's extra columns.
class NpyRows {
 public:
    // `names`: the fields, in this order; none: all. `job` outlives the object. Errors: kUsage, listing the fields that there are.
    static Result<NpyRows> of(const sampledb::Job& job, const std::vector<std::string>& names);

    const sampledb::ColumnSet& columns() const { return columns_; }  // that the fields take

    // The beginning of the file; as long for any number of rows.
    std::string header(std::uint64_t rows) const;

    // The first `rows` rows of a page, one behind the other. Good until the next call.
    ByteSpan encode(const sampledb::Page& page, std::size_t rows);

 private:
    enum class Source : std::uint8_t { kSample, kClass, kU, kV, kShare, kX, kY, kZ, kLambda, kPower, kExtra };
    struct Field {
        std::string name, type;  // "<f4"
        Source source;
        std::size_t count, width;  // values, bytes of one
        std::size_t extra = 0;     // which extra column
    };
    explicit NpyRows(const sampledb::Job& job) : job_(&job) {}
    static std::vector<Field> all_fields(const sampledb::Job& job);
    void put(const Field& field, const sampledb::Page& page, std::size_t rows, std::byte* to) const;
    void put_pairs(const Field& field, const sampledb::Page& page, std::size_t rows, std::byte* to) const;

    const sampledb::Job* job_;
    std::vector<Field> fields_;
    sampledb::ColumnSet columns_{false, false, false, false, {}};
    std::size_t row_bytes_ = 0;
    Bytes bytes_;
};

}  // namespace latent::inspect
