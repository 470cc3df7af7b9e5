// tools/inspect/help.h: what the commands of latent-inspect say about themselves.
#pragma once

namespace latent::inspect::help {

inline constexpr const char* kTool = R"(
latent-inspect COMMAND --help explains each command, with examples.

Exit status: 0 done; 1 failed; 2 wrong usage; 3 done, but something damaged was left out, or the report of
an output could not be written; 4 verify found damage.)";

inline constexpr const char* kInfo = R"(
Job, film, samples, runs, and what each column costs (estimated if there are many pages: fast at any size).
What is damaged is left out and listed, with exit status 3; as far as it is noticed: verify reads every byte.
--json lists the runs that count, with the samples and the content hash of each. --memory bounds the list of runs.

Examples:
  latent-inspect info night.latent
  latent-inspect info night-*.latent --json              one object for a file, an array for several)";

inline constexpr const char* kVerify = R"(
Every stored byte is compared with its checksum; the first thing wrong is named first. An attempt (NAME.latent.part.*) is sound
if all of its complete runs are; a published name that lacks its footer is damaged. --strict also lists, record by record, what breaks the
rules that readers rely on and need not check. Exit status 4 if anything is damaged or breaks a rule.

Examples:
  latent-inspect verify night.latent
  latent-inspect verify --quick night-*.latent      headers, indexes and one page of each run
  latent-inspect verify --deep night.latent         decode every record and check that it is where it belongs
  latent-inspect verify --strict other.latent       for writers: order, page cut, squares, shares, reserved bytes as well)";

inline constexpr const char* kRecover = R"(
Copies every run that is sound to a new file and verifies that; the input is never changed. What is lost is listed, with --json as a
ledger of byte and sample ranges, so that exactly these can be rendered again. Exit status 3 if anything was lost, 1 and no output if
everything was.

Examples:
  latent-inspect recover broken.latent -o saved.latent
  latent-inspect recover broken.latent -o saved-too.latent --json)";

inline constexpr const char* kCat = R"(
One record a line, in the order of the file. CSV columns: sample, class, u, v, share, then x, y, z, or the wavelengths [nm] and their
values, separated by spaces; then further columns of the job (extra.NAME if the name is taken).

Examples:
  latent-inspect cat night.latent --limit 20
  latent-inspect cat night.latent --samples 0:1024 --format json
  latent-inspect cat night.latent --region 0.45,0.45,0.55,0.55 > middle.csv)";

inline constexpr const char* kGen = R"(
Records made up from sample numbers, for tests and benches. Continues where it was interrupted, like a renderer.

Examples:
  latent-inspect gen -o small.latent --records 1M
  latent-inspect gen -o big.latent --records 1.07G --light 0.05 --aspect 3:2
  latent-inspect gen -o spectral.latent --records 10M --kind spectral --wavelengths 28
  latent-inspect gen -o far.latent --first 8589934592 --records 65536 --every 1023     sparse, beyond 2^32)";

}  // namespace latent::inspect::help
