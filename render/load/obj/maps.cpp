#include "render/load/obj/maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "render/load/files/unread.h"

namespace latent::render {

namespace {

std::optional<double> map_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double x = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), x);
    return fault == std::errc{} && end == word.data() + word.size() && std::abs(x) < 1e30 ? std::optional(x) : std::nullopt;
}

// The first of the places where the picture may be that is a file.
std::optional<std::string> find_file(std::string name, std::string mtl_name, const SceneFiles& files) {
    for (std::string* path : {&name, &mtl_name}) std::ranges::replace(*path, '\\', '/');
    const std::filesystem::path folder = std::filesystem::path(mtl_name).parent_path(), given(name);
    for (const std::filesystem::path& path : {folder / given, given, folder / given.filename(), given.filename()}) {
        std::error_code unknown;
        if (std::filesystem::is_regular_file(files.resolve(path.string()), unknown)) return path.string();
    }
    return std::nullopt;
}

}  // namespace

std::optional<MtlMap> read_map(const Statements& s, const std::string& mtl_name, SceneFiles& files) {
    // How many words follow an option at most; those of numbers may be fewer.
    static const std::map<std::string_view, std::size_t> kOptions = {
        {"-blendu", 1}, {"-blendv", 1}, {"-cc", 1}, {"-clamp", 1}, {"-texres", 1}, {"-imfchan", 1}, {"-type", 1},
        {"-bm", 1},     {"-boost", 1},  {"-mm", 2}, {"-o", 3},     {"-s", 3},      {"-t", 3},       {"-colorspace", 1}};
    MtlMap out{.texture = {.kind = TextureKind::kImage}};
    std::array<double, 2> offset{0, 0}, scale{1, 1};
    std::string name;
    std::size_t i = 1;
    while (i < s.words().size()) {
        const std::string_view option = s.words()[i];
        const auto known = kOptions.find(option);
        if (known == kOptions.end()) {
            // The name, which ends where options follow it.
            if (!name.empty()) break;
            const std::size_t first = i;
            while (i < s.words().size() && !kOptions.contains(s.words()[i])) ++i;
            name = s.rest(first, i);
            continue;
        }
        std::vector<double> numbers;
        const bool is_word = option == "-clamp" || option == "-imfchan" || option == "-type" || option.starts_with("-blend") ||
                             option == "-cc" || option == "-colorspace";
        const std::string_view word = i + 1 < s.words().size() ? s.words()[i + 1] : std::string_view();
        ++i;
        if (is_word) {
            ++i;
        } else {
            while (numbers.size() < known->second && i < s.words().size()) {
                const std::optional<double> x = map_number(s.words()[i]);
                if (!x) break;
                numbers.push_back(*x);
                ++i;
            }
        }
        if (option == "-o") std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 2), offset.begin());
        if (option == "-s") std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 2), scale.begin());
        if (option == "-bm" && !numbers.empty()) out.strength = numbers[0];
        if (option == "-clamp" && word == "on") out.texture.picture.wrap.fill(TextureWrap::kClamp);
        if (option == "-imfchan" && word == "r") out.channel = PictureChannel::kRed;
        if (option == "-imfchan" && word == "g") out.channel = PictureChannel::kGreen;
        if (option == "-imfchan" && word == "b") out.channel = PictureChannel::kBlue;
        if (option == "-imfchan" && word == "m") out.channel = PictureChannel::kAlpha;
        if (const UnreadFeatures* const unread = find_unread(SceneLanguage::kObj, "options of maps", option))
            s.say_of_unread(std::string(option), fmt::format("{}: {} is ignored", s.keyword(), option), *unread);
    }
    if (name.empty()) {
        s.warn(fmt::format("{}: names no file, and is ignored", s.keyword()));
        return std::nullopt;
    }
    const std::optional<std::string> file = find_file(name, mtl_name, files);
    const Result<Hash128> content = file ? files.hash(*file) : Result<Hash128>(Error{});
    if (!content) {
        s.warn(fmt::format("{}: {}: cannot be opened; the material is without it", s.keyword(), name.substr(0, 200)));
        return std::nullopt;
    }
    const Result<AlphaUse> alpha = files.alpha_use(*file);
    if (!alpha) {
        s.warn(fmt::format("{}: {}; the material is without it", s.keyword(), alpha.error().message));
        return std::nullopt;
    }
    out.alpha = *alpha;
    out.texture.mapping.s = {scale[0], 0};
    out.texture.mapping.t = {0, scale[1]};
    out.texture.mapping.delta_u = offset[0];
    out.texture.mapping.delta_v = offset[1];
    PictureDescription& picture = out.texture.picture;
    picture.path = files.resolve(*file).string();
    picture.name = s.place() + ": " + picture.path;
    picture.content = *content;
    picture.filter = TextureFilter::kTrilinear;
    return out;
}

}  // namespace latent::render
