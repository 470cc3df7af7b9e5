#include "tests/fuzz/target.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/faults/process.h"

namespace latent::fuzz {

void require(bool holds, const char* law) {
    if (holds) return;
    std::fprintf(stderr, "does not hold: %s\n", law);
    std::abort();
}

std::filesystem::path as_file(const std::string& name, ByteSpan bytes) {
    // In memory, where the system has such a folder.
    static const testing::TemporaryFolder folder(std::filesystem::exists("/dev/shm") ? "/dev/shm"
                                                                                     : std::filesystem::temp_directory_path());
    std::filesystem::path path = folder / name;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    require(static_cast<bool>(out.flush()), "a temporary file can be written");
    return path;
}

}  // namespace latent::fuzz
