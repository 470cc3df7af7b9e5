// tests/faults/fault_probe.cpp: writes, copies, reads back and publishes a file, so that faults_test can see each of its calls
// fail. Usage: fault_probe SOURCE TARGET
#include <fmt/format.h>

#include "base/file.h"

int main(int, char** argv) {
    using namespace latent;
    const auto fail = [](const Status& status) {
        fmt::print(stderr, "{}\n", status.error().message);
        return 1;
    };
    Result<File> source = File::open_read(argv[1]);
    if (!source) return fail(Status(tl::unexpect, source.error()));
    Result<OutputFile> out = OutputFile::create(argv[2], false);
    if (!out) return fail(Status(tl::unexpect, out.error()));
    const Bytes header(5000, std::byte{7});
    if (Status s = out->file().write_all(0, header); !s) return fail(s);
    if (Status s = out->file().copy_from(*source, 0, header.size(), *source->size()); !s) return fail(s);
    Bytes back(header.size());
    if (Status s = out->file().read_exact(0, back); !s) return fail(s);
    if (back != header) return 3;
    if (Status s = out->publish(); !s) return fail(s);
    return 0;
}
