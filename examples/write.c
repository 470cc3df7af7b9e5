/* examples/write.c: a renderer in a hundred lines that keeps every sample: a ball on a floor under a sky, with 4
 * wavelengths per sample. Usage: write NAME.latent [SAMPLES [SEED [CHECKPOINT_SECONDS]]]. Run it again after kill -9: it resumes.
 *     cc -std=c11 write.c $(pkg-config --cflags --libs latent) -lm -lpthread -o write */
#include <latent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <threads.h>

enum { kThreads = 4, kWavelengths = 4 };
static const double kFirst = 380, kLast = 780; /* nm */

typedef struct {
    double x, y, z;
} Vec;
static double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* SplitMix64: the numbers of a sample depend on its number and the seed alone, so any thread may render it, at any time. */
static double uniform(uint64_t* state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* Radiance of the sky, in W m^-2 sr^-1 nm^-1: bluer towards the zenith. */
static double sky(Vec d, double nm) { return 0.02 + 0.1 * fmax(d.y, 0) * pow(550 / nm, 4); }

/* Radiance along a ray from (0, 1, 3) in direction d: one bounce off a red ball or a grey floor, to where a random direction leads.
 */
static double radiance(Vec d, double nm, Vec random) {
    const Vec eye = {0, 1, 3}, from_ball = {eye.x, eye.y - 1, eye.z}; /* the ball: centre (0, 1, 0), radius 1 */
    const double b = dot(from_ball, d), root = b * b - dot(from_ball, from_ball) + 1;
    if (root > 0 && -b - sqrt(root) > 0) {
        const double t = -b - sqrt(root), reflectance = nm > 600 ? 0.8 : 0.1;
        const Vec n = {from_ball.x + t * d.x, from_ball.y + t * d.y, from_ball.z + t * d.z};
        const Vec out = {n.x + random.x, n.y + random.y, n.z + random.z}; /* cosine-weighted about n */
        return out.y > 0 ? reflectance * sky(out, nm) / fmax(sqrt(dot(out, out)), 1e-6) : 0.2 * reflectance * sky(n, nm);
    }
    if (d.y >= 0) return sky(d, nm);
    const Vec up = {random.x, fabs(random.y), random.z};
    return 0.4 * sky(up, nm);
}

typedef struct {
    latent_writer* writer;
    uint64_t seed;
} Work;

/* Renders grain after grain until none is left. */
static int render(void* argument) {
    const Work* work = argument;
    static _Thread_local uint64_t sample[LATENT_GRAIN];
    static _Thread_local uint32_t u[LATENT_GRAIN], v[LATENT_GRAIN];
    static _Thread_local uint16_t pairs[LATENT_GRAIN];
    static _Thread_local float power[LATENT_GRAIN * kWavelengths], lambda[LATENT_GRAIN * kWavelengths];
    latent_range grain;
    latent_error error;
    while (latent_writer_next(work->writer, &grain)) {
        size_t count = 0, pair = 0;
        for (uint64_t n = grain.first; n < grain.end; ++n, ++count) {
            uint64_t state = work->seed * 0xD1342543DE82EF95u ^ n * 0xA0761D6478BD642Fu;
            const double at_u = uniform(&state), at_v = uniform(&state), xi = uniform(&state);
            sample[count] = n;
            u[count] = (uint32_t)(at_u * 0x1p32);
            v[count] = (uint32_t)(at_v * 0x1p32);
            Vec d = {(at_u - 0.5) * 1.5, (0.5 - at_v), -1}; /* the film is 3 : 2 */
            const double length = sqrt(dot(d, d)), z = 1 - 2 * uniform(&state), phi = 6.283185307179586 * uniform(&state);
            d = (Vec){d.x / length, d.y / length, d.z / length};
            const Vec random = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z};
            pairs[count] = kWavelengths;
            for (int i = 0; i < kWavelengths; ++i, ++pair) {
                lambda[pair] = (float)(kFirst + (kLast - kFirst) * (xi + i) / kWavelengths); /* density p = 1 / (kLast - kFirst) */
                power[pair] = (float)(radiance(d, lambda[pair], random) * (kLast - kFirst) / kWavelengths); /* L / (k p) */
            }
        }
        const latent_records records = {.size = sizeof records,
                                        .count = count,
                                        .sample = sample,
                                        .u = u,
                                        .v = v,
                                        .pairs = pairs,
                                        .power = power,
                                        .lambda_nm = lambda,
                                        .pair_count = pair};
        if (latent_writer_submit(work->writer, grain, &records, &error) != LATENT_OK) {
            fprintf(stderr, "write: %s\n", error.message);
            latent_writer_stop(work->writer); /* this grain will not come: the other threads need not wait for it */
            return 1;
        }
    }
    return 0;
}

int main(int argc, char** argv) {
    if (argc < 2) return fprintf(stderr, "usage: write NAME.latent [SAMPLES [SEED [CHECKPOINT_SECONDS]]]\n"), 2;
    const uint64_t samples = argc > 2 ? strtoull(argv[2], NULL, 10) : 1 << 20, seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    /* The id stands for everything that shapes a record: here that is this program's version and the seed. */
    const latent_job job = {.size = sizeof job,
                            .id_low = seed,
                            .id_high = 0x6578616D706C6531,
                            .aspect_width = 3,
                            .aspect_height = 2,
                            .kind = LATENT_SPECTRAL,
                            .batch = kWavelengths,
                            .light_unit = 683};
    const latent_write_options options = {.size = sizeof options,
                                          .samples = {0, samples},
                                          .provenance = "{\"program\": \"write.c\"}",
                                          .checkpoint_seconds = argc > 4 ? strtod(argv[4], NULL) : 60};
    latent_error error;
    Work work = {NULL, seed};
    if (latent_writer_open(argv[1], &job, &options, &work.writer, &error) != LATENT_OK) {
        fprintf(stderr, "write: %s\n", error.message);
        return 1;
    }
    thrd_t threads[kThreads];
    int started = 0, failed = 0;
    while (started < kThreads && thrd_create(&threads[started], render, &work) == thrd_success) ++started;
    for (int i = 0; i < started; ++i) {
        int result = 1;
        thrd_join(threads[i], &result);
        failed |= result;
    }
    if (!failed && latent_writer_finish(work.writer, &error) != LATENT_OK)
        failed = 1, fprintf(stderr, "write: %s\n", error.message);
    latent_writer_close(work.writer);
    return failed;
}
