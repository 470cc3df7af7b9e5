// base/output_set.h: files and folders that belong together and get their names together.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "base/temporary_path.h"

namespace latent {

// Outputs of one folder: all get their names, or none does and what had these names stays. They are made in a hidden folder beside
// them, `hidden_name` of the first; the next set of the same first name removes what a killed process left there. The last item is
// the one that refers to the others: it is named when they are, so if the process is killed in the midst of naming, it is missing.
class OutputSet {
 public:
    struct Item {
        std::filesystem::path name;
        bool is_folder = false;
    };

    // Errors: kExists if a name is taken and `replace` is false (checked again by `publish`), or taken by something of another
    // kind; kIo.
    static Result<OutputSet> create(std::vector<Item> items, bool replace);
    OutputSet(OutputSet&&) noexcept;
    OutputSet& operator=(OutputSet&&) = delete;
    ~OutputSet();  // what has no name is removed

    // Where to make item `i`, a new file or folder.
    std::filesystem::path place(std::size_t i) const;
    // After all are made and synced: names them.
    Status publish();

 private:
    OutputSet() = default;
    Status make_hidden();

    std::vector<Item> items_;
    bool replace_ = false;
    TemporaryPath hidden_;
    int lock_ = -1;  // on `hidden_`
};

}  // namespace latent
