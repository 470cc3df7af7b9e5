#include "render/load/gltf/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/near_names.h"
#include "render/load/files/unread.h"
#include "render/load/gltf/schema.h"

namespace latent::render {

namespace {

using Holds = GltfMember::Holds;

bool refused(const GltfValue& value, const std::string& why) {
    value.error(why);
    return false;
}

// Reports only the first wrong item: if one has the wrong type, usually all have.
template <class Check>
bool each(const GltfValue& value, std::string_view what, const Check& check) {
    if (!value.is_array()) return refused(value, fmt::format("must be an array of {}", what));
    for (std::size_t i = 0; i < value.size(); ++i) {
        if (!check(value[i])) return false;
    }
    return true;
}
bool must_be_text(const GltfValue& value) { return value.is_text() || refused(value, "must be a string"); }
bool must_be_number(const GltfValue& value) { return value.is_number() || refused(value, "must be a finite number"); }
bool must_be_count(const GltfValue& value) { return value.is_count() || refused(value, "must be a non-negative integer"); }
bool must_be_object(const GltfValue& value) { return value.is_object() || refused(value, "must be an object"); }

bool check_object(const GltfValue& value, const GltfObjectType& type);

bool check_objects(const GltfValue& value, const GltfObjectType& type) {
    if (!each(value, "objects", must_be_object)) return false;
    bool good = true;
    for (std::size_t i = 0; i < value.size(); ++i) good = check_object(value[i], type) && good;
    return good;
}

void tell_of_unread(const GltfValue& value, const GltfMember& member) {
    const UnreadFeatures* const unread = find_unread(SceneLanguage::kGltf, member.kind, member.name);
    value.say_of_unread(std::string(unread->why), "is not used", *unread);
}

bool check_member(const GltfValue& value, const GltfMember& member) {
    switch (member.holds) {
        case Holds::kAnything:
            return true;
        case Holds::kUnread:
            tell_of_unread(value, member);
            return true;
        case Holds::kText:
            return must_be_text(value);
        case Holds::kFlag:
            return value.is_flag() || refused(value, "must be true or false");
        case Holds::kNumber:
            return must_be_number(value);
        case Holds::kCount:
            return must_be_count(value);
        case Holds::kNumbers:
            if (value.is_array() && value.size() == member.size) return each(value, "numbers", must_be_number);
            return refused(value, fmt::format("must be an array of {} numbers", member.size));
        case Holds::kCounts:
            return each(value, "indices", must_be_count);
        case Holds::kTexts:
            return each(value, "strings", must_be_text);
        case Holds::kObject:
            return check_object(value, *member.type);
        case Holds::kObjects:
            return check_objects(value, *member.type);
    }
    return true;
}

// "baseColourFactor": near to a name that the type knows. Names that begin with '_' are the application's own.
void warn_of_unknown(const GltfValue& value, std::string_view name, const GltfObjectType& type) {
    std::vector<std::string> names;
    for (const GltfMember& member : type.members) names.emplace_back(member.name);
    const std::string near = near_names(name, names);
    value.warn_of_kind(
        fmt::format("{}{}", name, static_cast<const void*>(&type)),
        fmt::format("is not part of glTF 2.0, and is ignored{}", near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

// TEXCOORD_1 is what TEXCOORD_0 is.
std::string first_of_set(const std::string& name) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    return digits > 1 && digits < name.size() && name[digits - 1] == '_' ? name.substr(0, digits) + "0" : name;
}

bool check_object(const GltfValue& value, const GltfObjectType& type) {
    if (!must_be_object(value)) return false;
    bool good = true;
    for (const std::string& name : value.keys()) {
        const auto exact = std::ranges::find(type.members, name, &GltfMember::name),
                   member =
                       exact != type.members.end() ? exact : std::ranges::find(type.members, first_of_set(name), &GltfMember::name);
        if (member != type.members.end() && !value[name].exists()) {
            value[name].warn_of_kind("null", "is null, and is ignored");
        } else if (member != type.members.end()) {
            good = check_member(value[name], *member) && good;
        } else if (!type.is_open && name != "extras" && name != "extensions" && !name.starts_with('_')) {
            warn_of_unknown(value[name], name, type);
        }
    }
    std::vector<std::string_view> missing;
    for (const GltfMember& member : type.members) {
        if (member.required && !value[member.name].exists()) missing.push_back(member.name);
    }
    if (!missing.empty()) value.error(fmt::format("has no {}", fmt::join(missing, ", ")));
    return good && missing.empty();
}

}  // namespace

bool check_gltf(const GltfValue& root) { return check_object(root, gltf_document()); }

}  // namespace latent::render
