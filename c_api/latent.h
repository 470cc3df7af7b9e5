/* c_api/latent.h: read, write and merge .latent files from C, or from any language that can call C. For the meaning of the numbers,
 * see docs/format.md ("Records"); for examples, docs/library.md, examples/write.c and examples/read.c.
 *
 * Functions return LATENT_OK or another latent_status. With a non-null `error`, a failed call leaves its status and one line of
 * text there; `error` may always be null. A null pointer where one is required, or a struct of an unknown size, is LATENT_USAGE. No
 * function throws, ends the process or prints.
 *
 * Handles (latent_writer*, latent_reader*, latent_cursor*) that are null, were closed, or come from nowhere are LATENT_USAGE too;
 * functions without a status then return 0 or null, and closing does nothing. A handle that was closed never becomes valid again.
 *
 * Structs that begin with `size`: set it to sizeof the struct and every other field that you do not use to 0, as in
 *     latent_job job = {.size = sizeof job};
 * Later versions add fields at the end, and 0 there always means what older versions did.
 *
 * Threads: a writer and a reader may be used, and closed, by any number of threads at once; a cursor by one at a time. Strings are
 * UTF-8 and end in 0; names of files are whatever bytes the system has. Intervals of samples are first .. end-1. */
#ifndef LATENT_H
#define LATENT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define LATENT_API __attribute__((visibility("default")))
#else
#define LATENT_API
#endif

typedef enum latent_status {
    LATENT_OK = 0,
    LATENT_IO = 1,            /* an error of the system; the message gives the reason */
    LATENT_NO_SPACE = 2,      /* disk full or quota reached */
    LATENT_NOT_FOUND = 3,     /* no such file */
    LATENT_EXISTS = 4,        /* the output already exists */
    LATENT_FOREIGN = 5,       /* not a .latent file */
    LATENT_TRUNCATED = 6,     /* ends before it should */
    LATENT_CORRUPT = 7,       /* a checksum, a range or a structure is wrong */
    LATENT_UNSUPPORTED = 8,   /* of a later version of the format or of this library */
    LATENT_MISMATCH = 9,      /* belongs to another job or another range */
    LATENT_USAGE = 10,        /* the arguments contradict each other, or the order of calls is wrong */
    LATENT_OUT_OF_RANGE = 11, /* a value outside its range */
    LATENT_STOPPED = 12,      /* the writer was stopped; what was committed stays */
    LATENT_NO_MEMORY = 13
} latent_status;

typedef struct latent_error {
    int32_t status;
    char message[1020]; /* one line: what, where, what to do */
} latent_error;

/* Of the library, "0.2.0". */
LATENT_API const char* latent_version(void);

/* ---- Jobs: what all samples have in common ------------------------------------------------------------------------------- */

enum { LATENT_SPECTRAL = 1, LATENT_XYZ = 2 };                                                           /* record kinds */
enum { LATENT_CAMERA = 0, LATENT_LIGHT = 1 };                                                           /* record classes */
enum { LATENT_NO_SAMPLER = 0, LATENT_HALTON23 = 1, LATENT_PIXELS = 2 };                                 /* position samplers */
enum { LATENT_U8 = 1, LATENT_U16 = 2, LATENT_U32 = 3, LATENT_U64 = 4, LATENT_F32 = 5, LATENT_F64 = 6 }; /* column types */
#define LATENT_NO_INDEX 0xFFFFu
#define LATENT_GRAIN 1024u /* samples */

typedef struct latent_range {
    uint64_t first, end;
} latent_range;

typedef struct latent_knot {
    uint64_t cumulative; /* in units of 2^-48, from 0 at the first knot to 2^48 at the last */
    uint32_t wavelength; /* in units of 2^-20 nm */
    uint32_t zero;
} latent_knot;

typedef struct latent_column {
    const char* name; /* docs/format.md, "Registry" has names in use */
    uint32_t type;    /* LATENT_U8 .. LATENT_F64 */
    uint32_t zero;
} latent_column;

typedef struct latent_job {
    size_t size;
    uint64_t id_low, id_high;             /* identifies everything that shapes a record; files with one id are one rendering */
    uint32_t aspect_width, aspect_height; /* of the film; any two positive numbers */
    uint32_t kind;                        /* LATENT_SPECTRAL or LATENT_XYZ */
    uint32_t batch;                       /* spectral: k, most pairs of a record, 1..1024; XYZ: 0 */
    double light_unit;                    /* luminance of Y = 1 in cd/m^2: 683 for radiance in W m^-2 sr^-1 nm^-1; 0: 1 */
    uint32_t light_paths_per_sample;      /* 0: no light records */
    uint32_t precision;                   /* mantissa bits kept of values, 1..23, rounded without bias; 0: 23, all */
    uint32_t run_samples;                 /* S, a power of two, 2^10..2^22; 0: a suitable one */
    uint32_t sampler;                     /* unless LATENT_NO_SAMPLER: positions that follow it are derived, not stored */
    uint64_t run_bytes;                   /* R, most bytes of a run in memory; 0: 256 MiB */
    uint32_t shift_u, shift_v;            /* of the sampler */
    const latent_knot* knots;             /* the density that wavelengths are drawn from; null: wavelengths are stored */
    size_t knot_count;                    /* 0, or 2..4096 */
    const latent_column* extra;           /* further columns */
    size_t extra_count;                   /* at most 128 */
    uint32_t width, height;               /* LATENT_PIXELS: of the picture that samples are spread for, 1..2^20; else 0 */
} latent_job;

/* Positions of `count` samples by the job's sampler, in units of 2^-32 of the film. LATENT_USAGE without a sampler. */
LATENT_API latent_status latent_positions(const latent_job* job, const uint64_t* sample, size_t count, uint32_t* u, uint32_t* v,
                                          latent_error* error);
/* The k = job->batch wavelengths in nm, ascending, of each of `count` batches with offsets xi / 2^32: count * k values.
 * LATENT_USAGE without a density. Both functions check the job each time: call them for many samples at once. */
LATENT_API latent_status latent_wavelengths(const latent_job* job, const uint32_t* xi, size_t count, float* lambda_nm,
                                            latent_error* error);

/* ---- Records: columns of `count` values ---------------------------------------------------------------------------------- */

/* When writing, columns that the job does not have are ignored, and columns marked * may be null. When reading, columns that the
 * job does not have, or that were not asked for, are null. */
typedef struct latent_records {
    size_t size;
    size_t count;
    const uint64_t* sample;      /* sample number */
    const uint8_t* record_class; /* * LATENT_CAMERA or LATENT_LIGHT; null: all camera */
    const uint32_t* u;           /* position on the film in units of 2^-32: 0 left .. 1 right */
    const uint32_t* v;           /* 0 top .. 1 bottom */
    const float* share;          /* * of the sample's denominator; null: 1 in camera records, 0 in light records */
    const float *x, *y, *z;      /* XYZ jobs: CIE 1931, not normalised */
    const uint16_t* pairs;       /* spectral jobs: n, pairs of this record, 0..k; with a density 0, 1 or k */
    const float* power;          /*   P_i = L(lambda_i) / (k p(lambda_i)) of all records, one record after another */
    const float* lambda_nm;      /*   the same; when writing: only in jobs without a density */
    size_t pair_count;           /*   sum of `pairs`, the length of `power` and `lambda_nm` */
    const uint32_t* xi;          /*   with a density: offset of the record's batch */
    const uint16_t* index;       /* * with a density: which wavelength of its batch a record of n = 1 < k keeps, */
                                 /*   else LATENT_NO_INDEX; null: no such records */
    const void* const* extra;    /* job->extra_count columns, of the job's types */
    const uint32_t* first_pair;  /* reading, spectral: where each record's pairs begin in `power`; one more at the end */
    uint64_t run, page;          /* reading: where the records are from */
} latent_records;

/* ---- Writing --------------------------------------------------------------------------------------------------------------
 * A part is a range of samples under one name. Until it is finished, it is NAME.latent.part.<nonce> in the same folder, and every
 * committed run in it survives kill -9. Opening the same part again resumes: `latent_writer_next` then skips what is on disk.
 *
 *     latent_writer_open -> { latent_writer_next, latent_writer_submit } on any threads -> latent_writer_finish -> _close */

typedef struct latent_writer latent_writer;

typedef struct latent_write_options {
    size_t size;
    latent_range samples;      /* of this part; preferably from a multiple of S, samples per run */
    double checkpoint_seconds; /* interval of commits, the most work that a kill loses; 0: 60 */
    const char* provenance;    /* a JSON object: who wrote this, where and when; or null */
    uint32_t replace;          /* 1: start over, and replace what has this name */
    uint32_t zero;
} latent_write_options;

typedef struct latent_writer_info {
    size_t size;
    uint64_t samples_committed; /* of the range, by this attempt and earlier ones */
    uint64_t bytes_written, runs_written, checkpoints_written;
} latent_writer_info;

/* `path` ends in .latent. A finished file that holds a part of the range is extended. LATENT_MISMATCH if a file with this name is
 * of another job, or also holds other samples. */
LATENT_API latent_status latent_writer_open(const char* path, const latent_job* job, const latent_write_options* options,
                                            latent_writer** writer, latent_error* error);
/* Number of intervals of samples that were missing when the part was opened; the first `capacity` of them are stored in `ranges`,
 * which may be null if `capacity` is 0. */
LATENT_API size_t latent_writer_missing(const latent_writer* writer, latent_range* ranges, size_t capacity);
/* Gives the next missing grain, 1024 samples or fewer, in ascending order. Returns 1, or 0 when there are no more. */
LATENT_API int latent_writer_next(latent_writer* writer, latent_range* grain);
/* Copies all records of the samples of a grain, in any order; samples may have none. Blocks while the disk is behind, or while
 * 64 MiB wait for an older grain, so submit grains soon after `latent_writer_next` gives them. If a record does not fit the job:
 * LATENT_OUT_OF_RANGE, with sample and field in the message; nothing is taken, and the grain can be submitted again. */
LATENT_API latent_status latent_writer_submit(latent_writer* writer, latent_range grain, const latent_records* records,
                                              latent_error* error);
/* Commits everything up to the first missing grain, and returns when it is on disk. This also happens by itself, at intervals. */
LATENT_API latent_status latent_writer_checkpoint(latent_writer* writer, latent_error* error);
/* Call this if a grain will never be submitted: calls of `latent_writer_submit` that wait for it then return LATENT_STOPPED. */
LATENT_API void latent_writer_stop(latent_writer* writer);
/* Completes the file under its name. LATENT_USAGE if grains are missing. */
LATENT_API latent_status latent_writer_finish(latent_writer* writer, latent_error* error);
LATENT_API latent_status latent_writer_get_info(const latent_writer* writer, latent_writer_info* info, latent_error* error);
/* Work that is not committed is lost, unless the part is finished. Other threads that wait in `latent_writer_submit` return
 * LATENT_STOPPED. */
LATENT_API void latent_writer_close(latent_writer* writer);

/* ---- Reading --------------------------------------------------------------------------------------------------------------
 * A reader treats files and folders as one set of runs, in which no sample counts twice (docs/format.md, "Selection"). Unfinished
 * parts can be read while they are written, up to the last commit. Memory does not grow with the files, except for the list of
 * runs. */

typedef struct latent_reader latent_reader;

typedef struct latent_read_options {
    size_t size;
    uint32_t skip_duplicates;   /* 1: files named one by one may hold the same samples */
    uint32_t verify;            /* 1: read and check every byte first; 0: check each page when it is read */
    uint64_t job_low, job_high; /* if files or folders hold several jobs, the one to read; 0, 0: there is only one */
} latent_read_options;

typedef struct latent_reader_info {
    size_t size;
    uint64_t files, runs, pages;
    uint64_t samples;                              /* selected */
    uint64_t camera_records, light_records, pairs; /* of the runs; in full, even if a run counts only in part */
    uint64_t light_paths;                          /* N, which the light image is divided by */
    uint64_t left_out;                             /* damaged or foreign items, see latent_reader_left_out */
} latent_reader_info;

typedef struct latent_run {
    size_t size;
    const char* file; /* owned by the reader; a URL without user, password and query */
    uint64_t offset;  /* of its first byte */
    uint64_t samples, pages, camera_records, light_records, pairs;
    latent_range interval; /* from its first sample to its last; there may be gaps */
} latent_run;

/* Files, folders, names of unfinished parts, or http(s) URLs of files on servers that answer range requests. URLs need the module
 * latent_http.so of the same version, which the tools bring along; LATENT_UNSUPPORTED without it. `options` may be null. */
LATENT_API latent_status latent_reader_open(const char* const* paths, size_t count, const latent_read_options* options,
                                            latent_reader** reader, latent_error* error);
/* `job->knots`, `job->extra` and their names belong to the reader. */
LATENT_API latent_status latent_reader_job(const latent_reader* reader, latent_job* job, latent_error* error);
LATENT_API latent_status latent_reader_get_info(const latent_reader* reader, latent_reader_info* info, latent_error* error);
/* Number of intervals of the samples selected; the first `capacity` of them are stored, ascending. */
LATENT_API size_t latent_reader_coverage(const latent_reader* reader, latent_range* ranges, size_t capacity);
/* Runs 0 .. info.runs-1, ascending by first sample. */
LATENT_API latent_status latent_reader_run(const latent_reader* reader, uint64_t run, latent_run* info, latent_error* error);
/* How the samples were made, as their writers tell it: JSON, {"parts": [{"provenance": {...}, "samples": [[first, end], ...]},
 * ...]}, the same for parts and for the file that they were merged into. docs/format.md has the members in use. The text belongs to
 * the reader. The first call reads the headers of all files again. */
LATENT_API latent_status latent_reader_provenance(const latent_reader* reader, const char** json, latent_error* error);
/* Names from there: of light group i, as the column light_group counts them, and of material i, as the column material counts them,
 * from 1; "" without a name. Null after the last, or if the files do not tell. */
LATENT_API const char* latent_reader_light_group(const latent_reader* reader, uint64_t i);
LATENT_API const char* latent_reader_material(const latent_reader* reader, uint64_t i);
/* Item i of those left out when the files were opened, as "FILE: run 3: checksum mismatch"; null after the last. */
LATENT_API const char* latent_reader_left_out(const latent_reader* reader, uint64_t i);
/* Its cursors can still be used. */
LATENT_API void latent_reader_close(latent_reader* reader);

/* ---- Cursors: records, page by page -------------------------------------------------------------------------------------- */

typedef struct latent_cursor latent_cursor;

enum { LATENT_SAMPLES = 1, LATENT_POSITIONS = 2, LATENT_VALUES = 4, LATENT_WAVELENGTHS = 8, LATENT_SHARES = 16, LATENT_EXTRA = 32 };

typedef struct latent_selection {
    size_t size;
    uint32_t columns;      /* a sum of LATENT_SAMPLES .. LATENT_EXTRA; 0: all; wavelengths come with values */
    uint32_t classes;      /* 1: camera records only; 2: light records only; 0: both */
    latent_range samples;  /* 0, 0: all */
    latent_range runs;     /* 0, 0: all; gives every thread runs of its own */
    double u0, v0, u1, v1; /* region u0 <= u < u1, v0 <= v < v1; all 0: the film */
} latent_selection;

/* `selection` may be null: everything. */
LATENT_API latent_status latent_cursor_open(const latent_reader* reader, const latent_selection* selection, latent_cursor** cursor,
                                            latent_error* error);
/* The next page that has records of the selection, at most 6144 of them, in the order of the file; at the end, records->count is 0.
 * The columns belong to the cursor until its next call. LATENT_CORRUPT, LATENT_TRUNCATED and LATENT_UNSUPPORTED cost one page or
 * one run: call again to continue after it. */
LATENT_API latent_status latent_cursor_next(latent_cursor* cursor, latent_records* records, latent_error* error);
LATENT_API void latent_cursor_close(latent_cursor* cursor);

/* ---- Merging --------------------------------------------------------------------------------------------------------------
 * Files, folders and unfinished parts of one job become one file, in which no sample counts twice. Runs are copied as they are, and
 * the copies are checked: if nothing was left out, the inputs can then be deleted. The output appears when it is complete. */

enum { LATENT_VERIFY_STORED = 0, LATENT_VERIFY_QUICK = 1, LATENT_VERIFY_FULL = 2 };

typedef struct latent_merge_options {
    size_t size;
    uint32_t verify;  /* LATENT_VERIFY_STORED: every byte, by its checksum; QUICK: headers and indexes; FULL: every record */
    uint32_t replace; /* 1: an existing output is replaced */
    uint32_t skip_duplicates;                          /* 1: files named one by one may hold the same samples */
    uint32_t keep_going;                               /* 1: named inputs that cannot be used are left out, too */
    uint32_t compact;                                  /* 1: many small runs become a few large ones; records do not change */
    uint32_t threads;                                  /* maximum; 0: one per processor */
    uint64_t memory;                                   /* limit in bytes; 0: 1 GiB, at most half of what may be used */
    latent_range require;                              /* samples that must be present; 0, 0: no such condition */
    uint64_t job_low, job_high;                        /* if folders hold several jobs, the one to merge; 0, 0: there is only one */
    void (*progress)(void* context, double done);      /* null, or called at intervals with the fraction that is done, 0..1, */
    void (*left_out)(void* context, const char* item); /* null, or called for each damaged or foreign item, */
    void* context;                                     /* with this, on one thread at a time */
} latent_merge_options;

typedef struct latent_merge_info {
    size_t size;
    uint64_t samples, files, runs_in, runs_out, camera_records, light_records;
    uint64_t bytes;    /* of the output */
    uint64_t left_out; /* damaged or foreign items */
} latent_merge_info;

/* `output` ends in .latent. `options` and `info` may be null. After a failure, there is no output. LATENT_EXISTS if the output
 * already exists; LATENT_MISMATCH if required samples are missing, or if the inputs belong to several jobs. */
LATENT_API latent_status latent_merge(const char* const* paths, size_t count, const char* output,
                                      const latent_merge_options* options, latent_merge_info* info, latent_error* error);

#ifdef __cplusplus
}
#endif

#endif /* LATENT_H */
