// tools/inspect/help.h: notes and examples for --help of latent-inspect and its commands.
#pragma once

namespace latent::inspect::help {

inline constexpr const char* kTool = R"(
For help on a command, with examples: latent-inspect COMMAND --help

Exit status: 0 done; 1 failed; 2 wrong usage; 3 done, but damaged input was left
out, or the report of an output could not be written; 4 verify found damage.)";

inline constexpr const char* kInfo = R"(
Shows the job, film, samples and runs, and the size of each column. To be fast
on files of any size, column sizes are estimated if there are many pages. --json
also lists the runs in use, with their samples and content hashes.

Damaged runs are left out and listed, with exit status 3. info does not read
every byte; use verify for that.

Examples:
  latent-inspect info night.latent
  latent-inspect info night-*.latent --json
      one object for a file, an array for several)";

inline constexpr const char* kVerify = R"(
Compares every stored byte with its checksum. An unfinished NAME.latent.part.*
file is sound if all its complete runs are. Any other file without a footer is
damaged. --strict also lists violations of rules that readers rely on but need
not check.

Exit status: 4 if anything is damaged or breaks a rule.

Examples:
  latent-inspect verify night.latent
  latent-inspect verify --quick night-*.latent
      headers, indexes and one page of each run
  latent-inspect verify --deep night.latent
      also decode every record, and check its position and sample number
  latent-inspect verify --strict other.latent
      for authors of other writers: also check every rule of the format)";

inline constexpr const char* kRecover = R"(
Copies every intact run to a new file, then verifies that file. Losses are
listed. --json lists them as ranges of bytes and samples, so that you can render
these samples again.

Exit status: 3 if anything was lost; 1, without output, if everything was lost.

Examples:
  latent-inspect recover broken.latent -o saved.latent
  latent-inspect recover broken.latent -o saved-too.latent --json)";

inline constexpr const char* kCat = R"(
Prints one record per line, in the order of the file. The CSV columns are
sample, class, u, v and share; then x, y, z, or the wavelengths in nm and their
values, each separated by spaces; then the extra columns of the job, named
extra.NAME if the name is taken.

With --format npy, standard output must be a file. It becomes a structured array
for numpy.load, with the same columns. class is 0 (camera) or 1 (light).
lambda_nm and power have one value for each wavelength of a sample; records with
fewer end in zeros.

Examples:
  latent-inspect cat night.latent --limit 20
  latent-inspect cat night.latent --format npy --columns u,v,y > night.npy
  latent-inspect cat night.latent --samples 0:1024 --format json
  latent-inspect cat night.latent --region 0.45,0.45,0.55,0.55 > middle.csv)";

inline constexpr const char* kNoise = R"(
Develops the picture from all samples, the first half of them, a quarter, and so
on, and compares the halves of each. The standard error is that of areas of
16 x 16 pixels: relative to their luminance Y, and in code values (0 to 255) of
the print that latent-convert makes by default. Of half of the pixels it is
smaller than the median, and of 95 % smaller than the other number.

The forecast tells how many samples make the median 2 %, 1 % and 0.5 %, and what
CPU time and disk space these take. It is unknown how much time the samples of a
file took that was not finished.

The map shows where noise is: in an EXR file, the relative standard error; in a
PNG file, the noisiest 1 % of the pixels are white.

Examples:
  latent-inspect noise night.latent
  latent-inspect noise night.latent --size 1920 -o noise.png
  latent-inspect noise parts/ --json)";

inline constexpr const char* kGen = R"(
The records are a function of their sample numbers. Run the same command again
to resume.

Examples:
  latent-inspect gen -o small.latent --records 1M
  latent-inspect gen -o big.latent --records 1.07G --light 0.05 --aspect 3:2
  latent-inspect gen -o spectral.latent --records 10M --kind spectral
  latent-inspect gen -o far.latent --first 8Gi --records 64Ki --every 1023
      sparse, with sample numbers beyond 2^32)";

}  // namespace latent::inspect::help
