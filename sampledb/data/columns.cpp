#include "sampledb/data/columns.h"

namespace latent::sampledb {

std::size_t width(ColumnType type) {
    switch (type) {
        case ColumnType::kU8:
            return 1;
        case ColumnType::kU16:
            return 2;
        case ColumnType::kU32:
        case ColumnType::kF32:
            return 4;
        case ColumnType::kU64:
        case ColumnType::kF64:
            return 8;
    }
    return 0;
}

}  // namespace latent::sampledb
