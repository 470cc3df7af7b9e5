// Compiles docs/latent.ksy, decodes files with it, and prints what it finds as JSON: {file: what is in it, ...}.
// Usage: decode.cjs latent.ksy FILE...
const fs = require("fs");
const path = require("path");
const YAML = require("yaml");
const compiler = require("kaitai-struct-compiler");
const KaitaiStream = require("kaitai-struct/KaitaiStream");

const hex = (bytes) => Buffer.from(bytes).toString("hex");
// Stored low half first, printed high half first.
const hash128 = (bytes) => hex(Buffer.from(bytes).reverse());

// The class that the compiler makes of the description.
function load(source) {
  const module = { exports: {} };
  const require_stream = (name) => (name.endsWith("KaitaiStream") ? KaitaiStream : require(name));
  new Function("module", "exports", "require", source)(module, module.exports, require_stream);
  return module.exports.Latent || module.exports;
}

async function main([ksy, ...files]) {
  const sources = await compiler.compile("javascript", YAML.parse(fs.readFileSync(ksy, "utf8")), null, false);
  const Latent = load(sources["Latent.js"]);
  const of_run = (entry) => ({
    first: entry.firstSample, end: entry.endSample, camera_records: entry.cameraRecords, light_records: entry.lightRecords,
    pages: entry.pageCount, content_hash: hash128(entry.contentHash),
  });
  const found = {};
  for (const name of files) {
    const data = fs.readFileSync(name);
    const file = new Latent(new KaitaiStream(data.buffer.slice(data.byteOffset, data.byteOffset + data.length)));
    const job = file.header.job;
    const result = {
      job: hash128(job.jobId), aspect: [job.aspectWidth, job.aspectHeight], kind: job.recordKind, sampler: job.positionSampler,
      k: job.wavelengths, light_paths: job.lightPaths, light_unit: job.lightUnit, run_samples: job.runSamples,
      knots: job.knots.map((knot) => [knot.cumulative, knot.wavelength]),
      extra: job.extraColumns.map((column) => [hex(column.name), column.type]), provenance: job.provenance,
      precision: job.precision ?? 23, copies_are_equal: hex(file.headerCopy) === hex(data.subarray(0, file.header.copySize)),
      runs: [], footer: null,
    };
    for (const section of file.sections) {
      const body = section.body;
      if (section.magic.kind === Latent.SectionKind.RUN) {
        result.runs.push({
          ...of_run(body.entry), intervals: body.intervals.map((interval) => [interval.first, interval.end]),
          index: body.index.map((e) => [e.level, e.recordClass, e.x, e.y, e.records, e.pairs, e.decodedSize, e.storedSize]),
          columns: body.pages.map((page) => page.columns.map((c, i) => [c.number, c.transform, c.bits, c.s, c.planes.map(
            (plane, p) => [plane.codec, plane.size, hex(page.stored[i].planes[p])])])),
          padding: body.padding.length,
        });
      } else {
        result.footer = { entries: body.entries.map((e) => of_run(e.entry ?? e)), provenance: body.provenance, offset: body.offset };
      }
    }
    found[path.basename(name)] = result;
  }
  console.log(JSON.stringify(found));
}

main(process.argv.slice(2));
