#include "color/observer_file.h"

#include <filesystem>

#include "base/small_file.h"

namespace latent::color {

Result<Observer> observer_by_name_or_file(const std::string& name) {
    constexpr std::uint64_t kMax = 16 << 20;
    if (name.empty()) return Observer::cie1931();
    Result<Observer> known = Observer::by_name(name);
    if (known) return known;
    std::error_code ignored;
    const bool is_file = std::filesystem::exists(name, ignored);
    if (!is_file && name.ends_with(".csv")) return Error{ErrorCode::kNotFound, name + ": no such file"};
    if (!is_file) return usage_error(known.error().message);
    const Result<std::string> text = read_small_file(name, kMax, "a table of response curves");
    if (!text) return text.error();
    Result<Observer> observer = Observer::from_csv(*text, std::filesystem::path(name).filename().string());
    if (!observer) return observer.error().at(name);
    return observer;
}

}  // namespace latent::color
