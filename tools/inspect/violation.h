// tools/inspect/violation.h: a violation of a rule that readers need not check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace latent::inspect {

struct Violation {
    std::optional<std::size_t> run{}, page{}, record{};  // counted from 0: in the file, in the run, in the page
    std::string what{};                                  // how it is: "its entry names the square 2 (0, 1)"
    std::string wanted{};                                // how it should be
};

// The first of them, and how many there are: one mistake of a writer may show in every record.
class Violations {
 public:
    static constexpr std::size_t kMaxListed = 1000;

    void add(Violation violation) {
        if (listed_.size() < kMaxListed) listed_.push_back(std::move(violation));
        ++count_;
    }
    void append(Violations others) {
        const std::uint64_t unlisted = others.count_ - others.listed_.size();
        for (Violation& violation : others.listed_) add(std::move(violation));
        count_ += unlisted;
    }
    const std::vector<Violation>& listed() const { return listed_; }
    std::uint64_t count() const { return count_; }

 private:
    std::vector<Violation> listed_;
    std::uint64_t count_ = 0;
};

}  // namespace latent::inspect
