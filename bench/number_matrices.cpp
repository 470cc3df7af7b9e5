// bench/number_matrices.cpp: the search for render/sampling/number_matrices.h.
//   number_matrices [SEED [TRIALS [RUNS]]]     the table was made with 20 600 3, in some seconds
// The matrices of all numbers grow by one column at a time, 12 in all: of up to TRIALS columns that keep a matrix a (0,1)-sequence,
// the one is taken that makes the weighted squares of t least, over the groups of numbers that a path uses together. Of RUNS such
// sets, the best is printed. Further columns are random.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

enum Number {
    kX,
    kY,
    kLightU,
    kLightV,
    kDirectionU,
    kDirectionV,
    kLensU,
    kLensV,
    kTime,
    kXi,
    kDistance,
    kNextLightU,
    kNextLightV,
    kNextDirectionU,
    kNextDirectionV,
    kLobe,
    kKept,
    kCount
};
constexpr int kColumns = 12;

using Matrix = std::array<std::uint32_t, 32>;  // row r: bit c is column c
using Matrices = std::array<Matrix, kCount>;

struct Group {
    std::vector<int> numbers;
    double weight;
};

bool is_independent(const std::uint32_t* rows, int count) {
    std::array<std::uint32_t, 32> basis{};
    for (int i = 0; i < count; ++i) {
        std::uint32_t x = rows[i];
        for (int j = 0; j < i; ++j) x = std::min(x, x ^ basis[static_cast<std::size_t>(j)]);
        if (x == 0) return false;
        basis[static_cast<std::size_t>(i)] = x;
    }
    return true;
}

// Whether all choices of `left` leading rows, of the matrices from `next` on, are independent of each other and of `rows`.
bool are_all_independent(const Matrices& matrices, const Group& group, std::size_t next, int left, std::uint32_t mask,
                         std::uint32_t* rows, int count) {
    const Matrix& matrix = matrices[static_cast<std::size_t>(group.numbers[next])];
    if (next + 1 == group.numbers.size()) {
        for (int i = 0; i < left; ++i) rows[count + i] = matrix[static_cast<std::size_t>(i)] & mask;
        return is_independent(rows, count + left);
    }
    for (int taken = 0; taken <= left; ++taken) {
        if (taken > 0) rows[count + taken - 1] = matrix[static_cast<std::size_t>(taken - 1)] & mask;
        if (!are_all_independent(matrices, group, next + 1, left - taken, mask, rows, count + taken)) return false;
    }
    return true;
}

// The least t for which the first 2^m points of the group are a (t, m, s)-net.
int t_of(const Matrices& matrices, const Group& group, int m) {
    std::array<std::uint32_t, 64> rows{};
    for (int t = 0; t < m; ++t) {
        if (are_all_independent(matrices, group, 0, m - t, (1u << m) - 1, rows.data(), 0)) return t;
    }
    return m;
}

// Groups by the last of their numbers.
std::array<std::vector<Group>, kCount> groups() {
    std::array<std::vector<Group>, kCount> all;
    const auto add = [&](std::vector<int> numbers, double weight) {
        std::ranges::sort(numbers);
        const auto last = static_cast<std::size_t>(numbers.back());
        all[last].push_back({std::move(numbers), weight});
    };
    for (int i = kLightU; i < kCount; ++i) {
        add({kX, i}, 1), add({kY, i}, 1), add({kX, kY, i}, 1.5);
        for (int j = kLightU; j < i; ++j) add({i, j}, 2.5);  // no two of them go together
    }
    const auto pair = [&](int a, int b, double w) {
        add({a, b}, 2 * w), add({kX, a, b}, w), add({kY, a, b}, w), add({kX, kY, a, b}, 3 * w);
    };
    pair(kLightU, kLightV, 12), pair(kDirectionU, kDirectionV, 2), pair(kLensU, kLensV, 1);
    pair(kNextLightU, kNextLightV, 1), pair(kNextDirectionU, kNextDirectionV, 1);
    const auto both = [&](int a, int b) { add({a, b}, .7), add({kX, kY, a, b}, .5); };
    for (const int a : {kLightU, kLightV}) {
        for (const int b : {kDirectionU, kDirectionV, kLensU, kLensV, kTime, kXi, kDistance}) both(a, b);
    }
    for (const int a : {kDirectionU, kDirectionV}) {
        for (const int b : {kLensU, kLensV, kDistance, kNextLightU, kNextLightV, kNextDirectionU, kNextDirectionV}) both(a, b);
    }
    add({kXi, kKept}, 1), add({kDirectionU, kKept}, .5), add({kDirectionV, kKept}, .5), add({kLightU, kLightV, kKept}, .5);
    add({kDirectionU, kDirectionV, kKept}, .7), add({kLobe, kKept}, .5);
    add({kDirectionU, kDirectionV, kLobe}, 2), add({kX, kDirectionU, kLobe}, 1), add({kY, kDirectionU, kLobe}, 1);
    add({kX, kDirectionV, kLobe}, 1), add({kY, kDirectionV, kLobe}, 1), add({kX, kY, kDirectionU, kDirectionV, kLobe}, 1.5);
    add({kLightU, kLightV, kLobe}, .5), add({kXi, kLobe}, .5);
    add({kLightU, kLightV, kLensU, kLensV}, 1), add({kLightU, kLightV, kTime}, 1), add({kLensU, kLensV, kTime}, 4),
        add({kLensU, kTime}, 8), add({kLensV, kTime}, 8), add({kLightU, kLightV, kDistance}, 1);
    add({kDirectionU, kDirectionV, kNextLightU, kNextLightV}, 1.5);
    add({kDirectionU, kDirectionV, kNextDirectionU, kNextDirectionV}, 1);
    add({kLightU, kLightV, kXi}, .5), add({kX, kY, kLightU, kLightV, kTime}, 1);
    return all;
}

void set_column(Matrix& matrix, int column, std::uint32_t bits, int rows) {
    for (int r = 0; r < rows; ++r) {
        std::uint32_t& row = matrix[static_cast<std::size_t>(r)];
        row = (row & ~(1u << column)) | (bits >> r & 1) << column;
    }
}

// The cost of the best column found for each number, or more than `most` if it cannot be that small.
double grow(Matrices& matrices, const std::array<std::vector<Group>, kCount>& all, int trials, double most, std::mt19937& random) {
    double total = 0;
    for (int m = 1; m <= kColumns && total <= most; ++m) {
        for (int number = kLightU; number < kCount; ++number) {
            Matrix& matrix = matrices[static_cast<std::size_t>(number)];
            double best = 1e18;
            std::uint32_t best_column = 0;
            for (int k = 0; k < (m <= 7 ? 1 << m : trials); ++k) {
                const std::uint32_t column = m <= 7 ? static_cast<std::uint32_t>(k) : random() & ((1u << m) - 1);
                set_column(matrix, m - 1, column, m);
                if (t_of(matrices, {{number}, 1}, m) != 0) continue;
                double cost = 0;
                for (const Group& group : all[static_cast<std::size_t>(number)]) {
                    const double t = t_of(matrices, group, m);
                    cost += group.weight * t * t;
                    if (cost >= best) break;
                }
                cost += random() % 1000 * 1e-6;  // which of equal ones
                if (cost < best) best = cost, best_column = column;
            }
            set_column(matrix, m - 1, best_column, m);
            total += best;
        }
    }
    return total;
}

}  // namespace

int main(int argc, char** argv) {
    const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
    std::mt19937 random(static_cast<std::uint32_t>(argument(1, 20)));
    const int trials = argument(2, 600), runs = argument(3, 3);
    const auto all = groups();
    Matrices best{};
    double least = 1e18;
    for (int run = 0; run < runs; ++run) {
        Matrices matrices{};
        for (std::uint32_t j = 0; j < 32; ++j) {
            matrices[kX][j] = 1u << j;
            for (std::uint32_t i = j; i < 32; ++i) matrices[kY][j] |= (i & j) == j ? 1u << i : 0;
        }
        const double cost = grow(matrices, all, trials, least, random);
        fmt::print(stderr, "run {}: {:.1f}\n", run, cost);
        if (cost < least) least = cost, best = matrices;
    }
    for (std::size_t number = kLightU; number < kCount; ++number) {
        for (int column = kColumns; column < 32; ++column) {
            const std::uint32_t bits = (random() & ((1u << column) - 1)) | 1u << column;
            for (std::size_t r = 0; r < 32; ++r) best[number][r] |= (bits >> r & 1) << column;
        }
        fmt::print("    {{");
        for (int column = 0; column < 32; ++column) {
            std::uint32_t digits = 0;
            for (std::size_t r = 0; r < 32; ++r) digits |= (best[number][r] >> column & 1) << r;
            fmt::print("0x{:08x}{}", digits, column < 31 ? ", " : "}");
        }
        fmt::print("{}\n", number + 1 < kCount ? "," : "");
    }
}
