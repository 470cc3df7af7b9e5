#include <pbrt/film.h>
#include <pbrt/filters.h>
#include <pbrt/paramdict.h>
#include <pbrt/util/error.h>
#include <pbrt/util/file.h>
#include <pbrt/util/sampling.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace pbrt {

// Samples of one thread, in the order in which they came; they get their numbers when they are submitted. Any numbers will do, for
// the job is this rendering alone.
struct LatentFilm::Batch {
    size_t samples = 0;
    std::vector<uint32_t> local;  // of each record: which sample of the batch it belongs to
    std::vector<uint8_t> recordClass;
    std::vector<uint32_t> u, v;
    std::vector<uint16_t> pairs;
    std::vector<float> power, lambda;
    std::vector<uint8_t> lensX, lensY, shutter;
    Point2f splatLens;

    void Clear() {
        samples = 0;
        local.clear(), recordClass.clear(), u.clear(), v.clear(), pairs.clear(), power.clear(), lambda.clear();
        lensX.clear(), lensY.clear(), shutter.clear();
    }
    void Add(const Batch& other) {
        for (uint32_t sample : other.local) local.push_back(uint32_t(samples) + sample);
        const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        append(recordClass, other.recordClass), append(u, other.u), append(v, other.v), append(pairs, other.pairs);
        append(power, other.power), append(lambda, other.lambda);
        append(lensX, other.lensX), append(lensY, other.lensY), append(shutter, other.shutter);
        samples += other.samples;
    }
};

namespace {

constexpr latent_column kColumns[] = {{"lens.x", LATENT_U8, 0}, {"lens.y", LATENT_U8, 0}, {"shutter", LATENT_U8, 0}};
constexpr int kShutter = 2;        // among these
constexpr double kUnit = 0x1p-32;  // of the film: what positions are counted in

// x of 0 .. size.
uint32_t FixedPoint(double x, int size) { return uint32_t(std::clamp(x / size / kUnit, 0.0, 1 / kUnit - 1)); }

// x of 0 .. 1, in 8 bits.
uint8_t Cell(Float x) { return uint8_t(std::min<Float>(x * 256, 255)); }

// A film point in its own pixel, though pbrt has rounded it to float, and its units will be rounded down.
double WithinPixel(Float x, int pixel, int size) {
    const double margin = 2 * kUnit * size;
    return std::clamp(double(x), pixel + margin, pixel + 1 - margin);
}

}  // namespace

LatentFilm* LatentFilm::Create(const ParameterDictionary& parameters, Float exposureTime, Filter filter,
                               const RGBColorSpace* colorSpace, const FileLoc* loc, Allocator alloc) {
    Float maxComponentValue = parameters.GetOneFloat("maxcomponentvalue", Infinity);
    bool writeFP16 = parameters.GetOneBool("savefp16", true);
    // As PixelSensor::Create has it.
    Float imagingRatio = exposureTime * parameters.GetOneFloat("iso", 100.f) / 100;
    PixelSensor* sensor = PixelSensor::Create(parameters, colorSpace, exposureTime, loc, alloc);
    FilmBaseParameters base(parameters, filter, sensor, loc);
    std::string samplesName = parameters.GetOneString("samples", RemoveExtension(base.filename) + ".latent");
    int precision = parameters.GetOneInt("precision", 23);
    bool wholeNm = parameters.GetOneBool("wholenm", false);
    bool keepsLens = parameters.GetOneBool("lens", false), keepsTime = parameters.GetOneBool("time", false);

    // Filters are chosen when a picture is developed; until then, samples lie where they fall.
    const BoxFilter* box = filter.CastOrNullptr<BoxFilter>();
    if (!box || box->Radius() != Vector2f(0.5f, 0.5f))
        ErrorExit(loc,
                  "Film \"latent\" needs PixelFilter \"box\" with a radius of 0.5; choose another filter with latent-develop.");
    if (base.pixelBounds != Bounds2i(Point2i(0, 0), base.fullResolution))
        ErrorExit(loc, "Film \"latent\" renders the whole film; choose a crop with latent-develop.");
    if (precision < 1 || precision > 23) ErrorExit(loc, "\"integer precision\": %d is not in 1 to 23.", precision);
    return alloc.new_object<LatentFilm>(base, colorSpace, maxComponentValue, writeFP16, imagingRatio, samplesName, precision,
                                        wholeNm, keepsLens, keepsTime, alloc);
}

LatentFilm::LatentFilm(FilmBaseParameters p, const RGBColorSpace* colorSpace, Float maxComponentValue, bool writeFP16,
                       Float imagingRatio, std::string samplesName, int precision, bool wholeNm, bool keepsLens, bool keepsTime,
                       Allocator alloc)
    : RGBFilm(p, colorSpace, maxComponentValue, writeFP16, alloc),
      imagingRatio(imagingRatio),
      samplesName(std::move(samplesName)),
      precision(precision),
      wholeNm(wholeNm),
      keepsLens(keepsLens),
      keepsTime(keepsTime),
      id([] {
          static std::atomic<uint64_t> films{0};
          return ++films;
      }()) {}

LatentFilm::~LatentFilm() { latent_writer_close(writer); }

void LatentFilm::SetLens(Float radius, Float focus, Bounds2f window) {
    lensRadius = radius;
    lensFocus = focus;
    lensWindow = window;
}

void LatentFilm::SetSplatLens(Point2f u) { ThreadBatch().splatLens = u; }

void LatentFilm::Open(int samplesPerPixel) {
    if (keepsLens && lensRadius <= 0)
        ErrorExit("Film \"latent\": \"bool lens\" needs Camera \"perspective\" with a \"float lensradius\" above 0.");
    sampleCount = uint64_t(samplesPerPixel) * uint64_t(pixelBounds.Area());
    std::random_device random;  // every rendering is a job of its own
    latent_job job{};
    job.size = sizeof job;
    job.id_low = uint64_t(random()) << 32 | random();
    job.id_high = uint64_t(random()) << 32 | random();
    job.aspect_width = uint32_t(fullResolution.x);
    job.aspect_height = uint32_t(fullResolution.y);
    job.kind = LATENT_SPECTRAL;
    job.batch = NSpectrumSamples;
    job.light_unit = 1;  // pbrt's lights are normalised such that one of scale 1 has Y = 1
    job.light_paths_per_sample = 1;
    job.precision = uint32_t(precision);
    job.extra = kColumns + (keepsLens ? 0 : kShutter);
    job.extra_count = (keepsLens ? 2 : 0) + (keepsTime ? 1 : 0);
    latent_write_options options{};
    options.size = sizeof options;
    options.samples = {0, sampleCount};
    std::string provenance = StringPrintf(R"({"program": "pbrt-v4", "resolution": [%d, %d])", fullResolution.x, fullResolution.y);
    if (lensRadius > 0)
        provenance += StringPrintf(R"(, "lens": {"radius": %f, "focus": %f, "window": [%f, %f, %f, %f]})", lensRadius, lensFocus,
                                   lensWindow.pMin.x, lensWindow.pMin.y, lensWindow.pMax.x, lensWindow.pMax.y);
    provenance += "}";
    options.provenance = provenance.c_str();
    latent_error error;
    const latent_status status = latent_writer_open(samplesName.c_str(), &job, &options, &writer, &error);
    if (status == LATENT_MISMATCH)
        ErrorExit("%s: holds the samples of another rendering. Remove it, or choose another file with \"string samples\".",
                  samplesName);
    if (status != LATENT_OK) ErrorExit("%s", std::string(error.message));
}

LatentFilm::Batch& LatentFilm::ThreadBatch() {
    thread_local Batch* mine = nullptr;
    thread_local uint64_t owner = 0;
    if (owner != id) {
        std::lock_guard<std::mutex> lock(mutex);
        batches.push_back(std::make_unique<Batch>());
        mine = batches.back().get();
        owner = id;
    }
    return *mine;
}

void LatentFilm::Append(Batch& batch, uint8_t recordClass, double x, double y, Point2f uLens, const SampledSpectrum& L,
                        const SampledWavelengths& lambda) const {
    // P_i = L(lambda_i) / (k p(lambda_i)), ascending by wavelength; of a black record, and of wavelengths that were terminated
    // (their density is 0), nothing.
    std::pair<float, float> sorted[NSpectrumSamples];
    int n = 0;
    const SampledSpectrum pdf = lambda.PDF();
    for (int i = 0; L && i < NSpectrumSamples; ++i) {
        if (pdf[i] == 0) continue;
        const float nm = wholeNm ? float(std::lround(lambda[i])) : float(lambda[i]);
        sorted[n++] = {nm, float(imagingRatio * L[i] / (NSpectrumSamples * pdf[i]))};
    }
    std::sort(sorted, sorted + n);
    batch.local.push_back(uint32_t(batch.samples));
    batch.recordClass.push_back(recordClass);
    batch.u.push_back(FixedPoint(x, fullResolution.x));
    batch.v.push_back(FixedPoint(y, fullResolution.y));
    batch.pairs.push_back(uint16_t(n));
    const Point2f lens = SampleUniformDiskConcentric(uLens);  // as cameras do
    batch.lensX.push_back(Cell((lens.x + 1) / 2));
    batch.lensY.push_back(Cell((lens.y + 1) / 2));
    for (int i = 0; i < n; ++i) batch.lambda.push_back(sorted[i].first), batch.power.push_back(sorted[i].second);
}

void LatentFilm::AddSplat(Point2f p, SampledSpectrum L, const SampledWavelengths& lambda) {
    RGBFilm::AddSplat(p, L, lambda);
    if (!L || p.x < 0 || p.y < 0 || p.x >= fullResolution.x || p.y >= fullResolution.y) return;
    Batch& batch = ThreadBatch();
    Append(batch, LATENT_LIGHT, p.x, p.y, batch.splatLens, L, lambda);
}

void LatentFilm::AddRecord(Point2i pPixel, const CameraSample& sample, int samplesPerPixel, const SampledSpectrum& L,
                           const SampledWavelengths& lambda) {
    std::call_once(opened, [&] { Open(samplesPerPixel); });
    Batch& batch = ThreadBatch();
    Append(batch, LATENT_CAMERA, WithinPixel(sample.pFilm.x, pPixel.x, fullResolution.x),
           WithinPixel(sample.pFilm.y, pPixel.y, fullResolution.y), sample.pLens, L, lambda);
    batch.shutter.resize(batch.local.size(), Cell(sample.time));  // splats, too, were at the time of their camera sample
    ++batch.samples;
    ++added;
    if (batch.samples < LATENT_GRAIN) return;
    latent_range grain;
    if (!latent_writer_next(writer, &grain)) return;  // all others are taken: the rest is for Finish
    if (grain.end - grain.first < LATENT_GRAIN) {
        std::lock_guard<std::mutex> lock(mutex);
        shortGrains.push_back(grain);
        return;
    }
    Submit(batch, 0, grain);
    batch.Clear();
}

// Samples firstSample and following of the batch become those of the grain.
void LatentFilm::Submit(const Batch& batch, size_t firstSample, latent_range grain) {
    const auto begin = std::lower_bound(batch.local.begin(), batch.local.end(), firstSample);
    const auto end = std::lower_bound(begin, batch.local.end(), firstSample + (grain.end - grain.first));
    const size_t first = size_t(begin - batch.local.begin()), count = size_t(end - begin);
    const size_t firstPair = std::accumulate(batch.pairs.begin(), batch.pairs.begin() + first, size_t(0));
    std::vector<uint64_t> sample(count);
    for (size_t i = 0; i < count; ++i) sample[i] = grain.first + (batch.local[first + i] - firstSample);
    latent_records records{};
    records.size = sizeof records;
    records.count = count;
    records.sample = sample.data();
    records.record_class = batch.recordClass.data() + first;
    records.u = batch.u.data() + first;
    records.v = batch.v.data() + first;
    records.pairs = batch.pairs.data() + first;
    records.power = batch.power.data() + firstPair;
    records.lambda_nm = batch.lambda.data() + firstPair;
    const void* extra[] = {batch.lensX.data() + first, batch.lensY.data() + first, batch.shutter.data() + first};
    records.extra = extra + (keepsLens ? 0 : kShutter);
    records.pair_count = std::accumulate(batch.pairs.begin() + first, batch.pairs.begin() + first + count, size_t(0));
    latent_error error;
    if (latent_writer_submit(writer, grain, &records, &error) != LATENT_OK)
        ErrorExit("%s: %s", samplesName, std::string(error.message));
}

void LatentFilm::Finish() {
    Batch rest;
    for (const std::unique_ptr<Batch>& batch : batches) rest.Add(*batch), batch->Clear();
    latent_range grain;
    std::vector<latent_range> grains = shortGrains;
    while (latent_writer_next(writer, &grain)) grains.push_back(grain);
    size_t first = 0;
    for (const latent_range& range : grains) {
        Submit(rest, first, range);
        first += range.end - range.first;
    }
    CHECK_EQ(first, rest.samples);
    latent_error error;
    if (latent_writer_finish(writer, &error) != LATENT_OK) ErrorExit("%s: %s", samplesName, std::string(error.message));
    latent_writer_close(writer);
    writer = nullptr;
}

void LatentFilm::WriteImage(ImageMetadata metadata, Float splatScale) {
    RGBFilm::WriteImage(metadata, splatScale);
    if (added == 0)
        ErrorExit(
            "Film \"latent\" was given no samples. It needs an integrator that follows paths from the camera, on the CPU: "
            "\"path\", \"volpath\" or \"bdpt\", for example.");
    if (writer && added == sampleCount) Finish();
}

std::string LatentFilm::ToString() const {
    return StringPrintf("[ LatentFilm samples: %s picture: %s ]", samplesName, RGBFilm::ToString());
}

}  // namespace pbrt
