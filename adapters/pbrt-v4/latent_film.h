// adapters/pbrt-v4/latent_film.h: Film "latent" for pbrt-v4: the picture of Film "rgb" and, beside it, every raw sample in a
// .latent file. In pbrt's namespace and names, for it becomes a part of pbrt: see `apply` and docs/library.md.
#ifndef PBRT_LATENT_FILM_H
#define PBRT_LATENT_FILM_H

#include <latent.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace pbrt {

class LatentFilm : public RGBFilm {
 public:
    // Parameters of its own, beside those of Film "rgb":
    //   string samples      the file; default: the name of the picture with the extension .latent
    //   integer precision   mantissa bits of values, 1 to 23; default: all 23
    //   bool lens           where the light of each record met the lens (columns lens.x, lens.y); default: false
    //   bool time           when it did (column shutter); default: false
    //   bool wholenm        wavelengths are rounded to whole nm, as pbrt's sensor rounds them; default: false
    static LatentFilm* Create(const ParameterDictionary& parameters, Float exposureTime, Filter filter,
                              const RGBColorSpace* colorSpace, const FileLoc* loc, Allocator alloc);

    // The lens of Camera "perspective"; no other camera has one, nor does a pinhole, whose radius is 0. `window` is what the film
    // shows of the plane at distance 1.
    void SetLens(Float radius, Float focus, Bounds2f window);
    // The random numbers for the point of the lens through which the next splat of this thread comes.
    void SetSplatLens(Point2f u);
    // A camera sample of pixel pPixel. What AddSplat was given on this thread since the last one belongs to it.
    void AddRecord(Point2i pPixel, const CameraSample& sample, int samplesPerPixel, const SampledSpectrum& L,
                   const SampledWavelengths& lambda);
    void AddSplat(Point2f p, SampledSpectrum L, const SampledWavelengths& lambda);
    // The picture; once all samples are there, also the file.
    void WriteImage(ImageMetadata metadata, Float splatScale = 1);

    std::string ToString() const;

    LatentFilm(FilmBaseParameters p, const RGBColorSpace* colorSpace, Float maxComponentValue, bool writeFP16, Float imagingRatio,
               std::string samplesName, int precision, bool wholeNm, bool keepsLens, bool keepsTime, Allocator alloc);
    LatentFilm(const LatentFilm&) = delete;
    ~LatentFilm();

 private:
    struct Batch;

    void Open(int samplesPerPixel);
    Batch& ThreadBatch();
    void Append(Batch& batch, uint8_t recordClass, double x, double y, Point2f uLens, const SampledSpectrum& L,
                const SampledWavelengths& lambda) const;
    void Submit(const Batch& batch, size_t firstSample, latent_range grain);
    void Finish();

    const Float imagingRatio;
    const std::string samplesName;
    const int precision;
    const bool wholeNm, keepsLens, keepsTime;
    const uint64_t id;  // of this film in this process
    Float lensRadius = 0, lensFocus = 0;
    Bounds2f lensWindow;
    std::once_flag opened;
    latent_writer* writer = nullptr;
    uint64_t sampleCount = 0;  // of the whole rendering
    std::atomic<uint64_t> added{0};
    std::mutex mutex;                             // of what follows
    std::vector<std::unique_ptr<Batch>> batches;  // one for each thread
    std::vector<latent_range> shortGrains;        // that were handed out, but are too short for a batch
};

}  // namespace pbrt

#endif  // PBRT_LATENT_FILM_H
