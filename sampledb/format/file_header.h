// sampledb/format/file_header.h: the header of a file, bytes <-> struct. docs/format.md, "Header".
#pragma once

#include <cstdint>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/data/job.h"

namespace latent::sampledb {

// The file header: the job, and where this file comes from. It stands twice at the start of a file, so that no single
// damage makes the runs behind it unreadable.
struct FileHeader {
    Job job;
    std::string provenance_json;  // "" or a JSON object
};
// Both copies, ready to be written at offset 0; a multiple of kBlock. Errors: kOutOfRange (job.validate(), provenance too long).
Result<Bytes> encode_file_header(const FileHeader& header);
// Decodes one copy from bytes that begin with it. `copy_size`, if given, becomes the bytes that one copy occupies.
// Errors: kForeign (another magic), kTruncated, kUnsupported (a newer format), kCorrupt.
Result<FileHeader> decode_file_header(ByteSpan bytes, std::uint64_t* copy_size = nullptr);

}  // namespace latent::sampledb
