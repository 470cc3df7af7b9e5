#include "base/near_names.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace latent {

namespace {

constexpr std::size_t kMaxNames = 5;

// Letters that must change, come, go or change places with the next one to make one of the other (Levenshtein's distance, and
// Damerau's transpositions of neighbours).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before = std::exchange(last, row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

// Some letters of `longer` left out, less than half: "canon5d" of "canoneos5d".
bool is_short_for(std::string_view name, std::string_view longer) {
    if (name.size() < 4 || longer.size() >= 2 * name.size() || longer.front() != name.front()) return false;
    std::size_t found = 0;
    for (const char c : longer) found += found < name.size() && name[found] == c ? 1 : 0;
    return found == name.size();
}

}  // namespace

std::string folded_name(std::string_view name) {
    std::string folded;
    for (const char c : name) {
        if (c == '-' || c == '_' || c == ' ') continue;
        folded += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return folded;
}

std::string near_names(std::string_view name, std::span<const std::string> names) {
    constexpr std::size_t kLongest = 64;  // longer ones are near to none
    const std::string wanted = folded_name(name.substr(0, kLongest));
    std::vector<std::pair<std::size_t, const std::string*>> near;
    for (const std::string& candidate : names) {
        const std::string other = folded_name(candidate);
        const std::size_t apart = distance(wanted, other);
        const bool contained = wanted.size() >= 2 && other.find(wanted) != std::string::npos;
        const bool contains = other.size() >= 3 && wanted.find(other) != std::string::npos;
        if (contained || contains || is_short_for(wanted, other) ||
            apart <= std::max<std::size_t>(1, std::min(wanted.size(), other.size()) / 3))
            near.push_back({contained || contains ? apart / 2 : apart, &candidate});
    }
    std::ranges::stable_sort(near, {}, &std::pair<std::size_t, const std::string*>::first);
    std::string list;
    for (std::size_t i = 0; i < std::min(kMaxNames, near.size()); ++i) list += (i == 0 ? "" : ", ") + *near[i].second;
    return list;
}

}  // namespace latent
