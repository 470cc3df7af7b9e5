/* examples/read.c: prints the counts of files, and the mean of their records as CIE X, Y, Z or as power per record.
 * Usage: read FILE... [--records]. With --records: one line for each record, all bits of its values.
 *     cc -std=c11 read.c $(pkg-config --cflags --libs latent) -o read */
#include <inttypes.h>
#include <latent.h>
#include <stdio.h>
#include <string.h>

static int fail(const latent_error* error) { return fprintf(stderr, "read: %s\n", error->message), 1; }

static uint32_t bits(float value) {
    uint32_t pattern;
    memcpy(&pattern, &value, sizeof pattern);
    return pattern;
}

static void print(const latent_records* r) {
    for (size_t i = 0; i < r->count; ++i) {
        printf("%" PRIu64 " %d %08" PRIx32 " %08" PRIx32 " %08" PRIx32, r->sample[i], r->record_class[i], r->u[i], r->v[i],
               bits(r->share[i]));
        if (r->x != NULL) printf(" %08" PRIx32 " %08" PRIx32 " %08" PRIx32, bits(r->x[i]), bits(r->y[i]), bits(r->z[i]));
        for (size_t p = 0; r->pairs != NULL && p < r->pairs[i]; ++p) {
            printf(" %08" PRIx32 ":%08" PRIx32, bits(r->lambda_nm[r->first_pair[i] + p]), bits(r->power[r->first_pair[i] + p]));
        }
        putchar('\n');
    }
}

int main(int argc, char** argv) {
    const int all = argc > 1 && strcmp(argv[argc - 1], "--records") == 0;
    latent_error error;
    latent_reader* reader;
    if (latent_reader_open((const char* const*)(argv + 1), (size_t)(argc - 1 - all), NULL, &reader, &error) != LATENT_OK) {
        return fail(&error);
    }
    latent_reader_info info = {.size = sizeof info};
    latent_job job = {.size = sizeof job};
    latent_cursor* cursor;
    if (latent_reader_get_info(reader, &info, &error) != LATENT_OK || latent_reader_job(reader, &job, &error) != LATENT_OK ||
        latent_cursor_open(reader, NULL, &cursor, &error) != LATENT_OK) {
        latent_reader_close(reader);
        return fail(&error);
    }
    if (!all) {
        printf("%" PRIu64 " samples, film %" PRIu32 ":%" PRIu32 " (files: %" PRIu64 ", runs: %" PRIu64 ")\n", info.samples,
               job.aspect_width, job.aspect_height, info.files, info.runs);
    }
    int status = info.left_out > 0 ? 3 : 0;
    for (uint64_t i = 0; i < info.left_out; ++i) fprintf(stderr, "read: left out: %s\n", latent_reader_left_out(reader, i));

    double sums[3] = {0, 0, 0}; /* x, y, z or power */
    uint64_t count = 0;
    for (;;) {
        latent_records r = {.size = sizeof r};
        const latent_status next = latent_cursor_next(cursor, &r, &error);
        if (next == LATENT_CORRUPT || next == LATENT_TRUNCATED || next == LATENT_UNSUPPORTED) {
            fprintf(stderr, "read: left out: %s\n", error.message);
            status = 3;
            continue;
        }
        if (next != LATENT_OK) status = fail(&error);
        if (next != LATENT_OK || r.count == 0) break;
        if (all) print(&r);
        count += r.count;
        for (size_t i = 0; r.x != NULL && i < r.count; ++i) sums[0] += r.x[i], sums[1] += r.y[i], sums[2] += r.z[i];
        for (size_t i = 0; r.x == NULL && i < r.pair_count; ++i) sums[0] += r.power[i];
    }
    if (!all && count > 0 && job.kind == LATENT_XYZ) {
        printf("%" PRIu64 " records, mean X Y Z %g %g %g\n", count, sums[0] / count, sums[1] / count, sums[2] / count);
    } else if (!all && count > 0) {
        printf("%" PRIu64 " records, mean power %g\n", count, sums[0] / count);
    }
    latent_cursor_close(cursor);
    latent_reader_close(reader);
    return status;
}
