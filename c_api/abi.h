// c_api/abi.h: the border of every function of latent.h: structs of any version in and out, errors as numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "base/result.h"
#include "c_api/latent.h"

namespace latent::c {

// A struct of the caller, whose header may be older (fewer fields: the others are 0) or newer (what is behind must be 0). `least`:
// its size in the first version. Errors: kUsage, kUnsupported.
template <class T>
Result<T> taken(const T* from, std::size_t least, const char* name) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (from == nullptr) return usage_error(std::string(name) + " is null");
    if (from->size < least || from->size > std::size_t{1} << 16)
        return usage_error(std::string(name) + ".size is not the size of the struct");
    const auto* bytes = reinterpret_cast<const unsigned char*>(from);
    for (std::size_t i = sizeof(T); i < from->size; ++i) {
        if (bytes[i] != 0)
            return Error{ErrorCode::kUnsupported, std::string(name) + " has a field that this version does not have"};
    }
    T value{};
    std::memcpy(&value, from, std::min(from->size, sizeof(T)));
    return value;
}

// The same towards the caller: as many fields as its struct has; fields that this version does not have are 0.
template <class T>
Status give(const T& value, T* to, std::size_t least, const char* name) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (to == nullptr) return usage_error(std::string(name) + " is null");
    const std::size_t size = to->size;
    if (size < least || size > std::size_t{1} << 16) return usage_error(std::string(name) + ".size is not the size of the struct");
    std::memset(to, 0, size);
    std::memcpy(to, &value, std::min(size, sizeof(T)));
    to->size = size;
    return {};
}

// Runs `call`, which returns a Status; nothing is thrown beyond. Fills `error`, if there is one.
latent_status report(const Status& status, latent_error* error) noexcept;
template <class Call>
latent_status guarded(latent_error* error, const Call& call) noexcept {
    try {
        return report(call(), error);
    } catch (...) {
        return report(current_error(), error);
    }
}

}  // namespace latent::c
