#include "tools/develop/origins.h"

#include "base/url.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"

namespace latent::develop {

Status for_each_origin(const sampledb::RunSet& run_set, const std::function<void(std::string_view)>& take) {
    if (run_set.runs().empty()) return {};
    const std::filesystem::path& path = run_set.files()[run_set.runs().front().file];
    const Result<std::shared_ptr<const sampledb::ByteSource>> source = sampledb::open_source(path);
    if (!source) return source.error();
    const Result<sampledb::FileContents> frames = sampledb::read_frames(**source);
    if (!frames) return frames.error().at(shown_name(path));
    sampledb::for_each_origin(*frames, take);
    return {};
}

}  // namespace latent::develop
