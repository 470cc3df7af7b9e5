/* bench/column_hashes.c: a number for every column of a file, by latent.h: for bench/agreement. Usage: column_hashes FILE
 * Of column values b_0, b_1, ... as bits: the sum over i of mix(b_i + (i + 1) * 0x9E3779B97F4A7C15) mod 2^64, with the finaliser of
 * SplitMix64. Pairs count as rows of k values, absent ones as 0. */
#include <inttypes.h>
#include <latent.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static uint64_t mix(uint64_t z) {
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}
static uint64_t term(uint64_t bits, uint64_t row) { return mix(bits + (row + 1) * 0x9E3779B97F4A7C15u); }
static uint64_t bits_of_double(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
static uint32_t bits_of_float(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

int main(int argc, char** argv) {
    enum { kSample, kClass, kU, kV, kShare, kX, kY, kZ, kPower, kWavelengths, kCount };
    static const char* const names[kCount] = {"sample", "class", "u", "v", "share", "x", "y", "z", "power", "wavelengths"};
    latent_reader* reader;
    latent_cursor* cursor;
    latent_error error;
    latent_job job = {.size = sizeof job};
    if (argc != 2) return 2;
    if (latent_reader_open((const char* const*)(argv + 1), 1, NULL, &reader, &error) != LATENT_OK ||
        latent_reader_job(reader, &job, &error) != LATENT_OK || latent_cursor_open(reader, NULL, &cursor, &error) != LATENT_OK) {
        return fprintf(stderr, "column_hashes: %s\n", error.message), 1;
    }
    uint64_t sums[kCount] = {0}, row = 0;
    clock_t reading = 0;
    for (;;) {
        latent_records r = {.size = sizeof r};
        const clock_t begin = clock();
        const latent_status status = latent_cursor_next(cursor, &r, &error);
        reading += clock() - begin;
        if (status != LATENT_OK) return fprintf(stderr, "column_hashes: %s\n", error.message), 1;
        if (r.count == 0) break;
        for (size_t i = 0; i < r.count; ++i, ++row) {
            sums[kSample] += term(r.sample[i], row);
            sums[kClass] += term(r.record_class[i], row);
            sums[kU] += term(bits_of_double(r.u[i] * 0x1p-32), row);
            sums[kV] += term(bits_of_double(r.v[i] * 0x1p-32), row);
            sums[kShare] += term(bits_of_float(r.share[i]), row);
            if (job.kind == LATENT_XYZ) {
                sums[kX] += term(bits_of_float(r.x[i]), row);
                sums[kY] += term(bits_of_float(r.y[i]), row);
                sums[kZ] += term(bits_of_float(r.z[i]), row);
                continue;
            }
            for (size_t p = 0; p < job.batch; ++p) {
                const int there = p < r.pairs[i];
                const size_t at = r.first_pair[i] + p;
                sums[kPower] += term(there ? bits_of_float(r.power[at]) : 0, row * job.batch + p);
                sums[kWavelengths] += term(there ? bits_of_float(r.lambda_nm[at]) : 0, row * job.batch + p);
            }
        }
    }
    printf("rows %" PRIu64 "\n", row);
    for (int i = 0; i < kCount; ++i) {
        if (job.kind == LATENT_XYZ ? i < kPower : i < kX || i >= kPower) printf("%s %016" PRIx64 "\n", names[i], sums[i]);
    }
    fprintf(stderr, "%.3f s of CPU time to read\n", (double)reading / CLOCKS_PER_SEC);
    latent_cursor_close(cursor);
    latent_reader_close(reader);
    return 0;
}
