# A description of .latent files for Kaitai Struct (https://kaitai.io): headers, runs, tables of pages, indexes and footers.
# It is made from docs/format.md, which decides. It does not check hashes, decode planes, or find its way in damaged files.
meta:
  id: latent
  title: Latent sample file
  file-extension: latent
  xref:
    mime: application/x-latent-samples
  license: Apache-2.0
  ks-version: 0.9
  endian: le
doc: |
  The raw samples of a rendering: a header in two copies, then runs of records, then a footer that lists the runs.
  An unfinished file has no footer, and may end inside a run.
doc-ref: docs/format.md
seq:
  - id: header
    type: file_header
  - id: header_copy
    size: header.copy_size
    doc: The same bytes again.
  - id: sections
    type: section
    repeat: eos
    doc: Runs, then a footer. Each begins at a multiple of 4096 bytes.
types:
  magic:
    seq:
      - id: start
        contents: [0x8d, LTDB]
      - id: kind
        type: u1
        enum: section_kind
      - id: newline
        contents: [0x0d, 0x0a]
  file_header:
    seq:
      - id: magic
        type: magic
      - id: major
        type: u2
        valid: 1
      - id: minor
        type: u2
      - id: copy_size
        type: u4
        valid:
          min: 4096
          max: 1048576
      - id: features
        type: u8
        doc: "Bit 0: precision is below 23."
      - id: body_size
        type: u8
      - id: body_hash
        size: 8
        doc: XXH3-64 of bytes 64 .. copy_size-1.
      - id: reserved
        size: 16
      - id: front_hash
        size: 8
        doc: XXH3-64 of bytes 0 .. 55.
      - id: job
        type: job
        size: body_size
      - id: padding
        size: copy_size - 64 - body_size
  job:
    doc: What all samples of the file have in common.
    seq:
      - id: job_id
        size: 16
        doc: Low half first.
      - id: aspect_width
        type: u4
      - id: aspect_height
        type: u4
      - id: record_kind
        type: u1
        enum: record_kind
      - id: position_sampler
        type: u1
        enum: sampler
      - id: wavelengths
        type: u2
        doc: k, per sample; 0 in XYZ jobs.
      - id: light_paths
        type: u4
        doc: Per sample.
      - id: light_unit
        type: f8
        doc: Luminance of Y = 1 in cd/m2.
      - id: run_bytes
        type: u8
        doc: R, the maximum of a run's raw bytes.
      - id: run_samples
        type: u4
        doc: S, samples per run.
      - id: shift_u
        type: u4
      - id: shift_v
        type: u4
      - id: knot_count
        type: u4
      - id: extra_column_count
        type: u4
      - id: provenance_size
        type: u4
      - id: knots
        type: knot
        repeat: expr
        repeat-expr: knot_count
      - id: extra_columns
        type: extra_column
        repeat: expr
        repeat-expr: extra_column_count
      - id: provenance
        type: str
        size: provenance_size
        encoding: UTF-8
      - id: precision
        type: u1
        if: _parent.minor >= 1
        doc: Mantissa bits of the values; 23 where it is absent.
      - id: width
        type: u4
        if: _parent.minor >= 2
        doc: W of the sampler pixels; 0 with another.
      - id: height
        type: u4
        if: _parent.minor >= 2
        doc: H of the sampler pixels; 0 with another.
  knot:
    seq:
      - id: cumulative
        type: u8
        doc: In units of 2^-48.
      - id: wavelength
        type: u4
        doc: In units of 2^-20 nm.
  extra_column:
    seq:
      - id: type
        type: u1
        enum: column_type
      - id: name_size
        type: u1
      - id: name
        size: name_size
        doc: UTF-8.
  section:
    seq:
      - id: magic
        type: magic
      - id: body
        type:
          switch-on: magic.kind
          cases:
            section_kind::run: run
            section_kind::footer: footer
            section_kind::first_footer: first_footer
  run_entry:
    doc: Bytes 8 .. 135 of the header of a run, which the footer repeats.
    seq:
      - id: major
        type: u2
      - id: minor
        type: u2
      - id: interval_count
        type: u4
      - id: features
        type: u8
      - id: job_id
        size: 16
      - id: first_sample
        type: u8
      - id: end_sample
        type: u8
      - id: sample_count
        type: u8
      - id: page_count
        type: u8
      - id: camera_records
        type: u8
      - id: light_records
        type: u8
      - id: pair_count
        type: u8
      - id: decoded_size
        type: u8
      - id: pages_size
        type: u8
      - id: index_hash
        size: 8
      - id: content_hash
        size: 16
        doc: Low half first.
  run:
    seq:
      - id: entry
        type: run_entry
      - id: zero
        size: 112
      - id: header_hash
        size: 8
        doc: XXH3-64 of the first 248 bytes of the run.
      - id: pages
        type: page
        repeat: expr
        repeat-expr: entry.page_count
      - id: intervals
        type: interval
        repeat: expr
        repeat-expr: entry.interval_count
      - id: index
        type: page_entry
        repeat: expr
        repeat-expr: entry.page_count
      - id: padding
        size: (4096 - (256 + entry.pages_size + 16 * entry.interval_count + 48 * entry.page_count) % 4096) % 4096
  interval:
    seq:
      - id: first
        type: u8
      - id: end
        type: u8
  page_entry:
    seq:
      - id: level
        type: u1
      - id: record_class
        type: u1
        enum: record_class
      - id: zero
        type: u2
      - id: x
        type: u4
      - id: y
        type: u4
      - id: records
        type: u4
      - id: pairs
        type: u4
      - id: decoded_size
        type: u4
      - id: content_hash
        size: 8
      - id: stored_size
        type: u4
      - id: zero_2
        type: u4
      - id: stored_hash
        size: 8
  page:
    seq:
      - id: column_count
        type: u4
      - id: columns
        type: column
        repeat: expr
        repeat-expr: column_count
      - id: stored
        type: stored_column(_index)
        repeat: expr
        repeat-expr: column_count
  column:
    seq:
      - id: number
        type: u1
        enum: column_number
        doc: 64 and above are the extra columns of the job.
      - id: transform
        type: u1
        enum: transform
      - id: bits
        type: u1
      - id: plane_count
        type: u1
        valid:
          max: 8
      - id: s
        type: u4
      - id: base
        type: u8
      - id: column_hash
        size: 8
        doc: XXH3-64 of the decoded values.
      - id: planes
        type: plane
        repeat: expr
        repeat-expr: plane_count
  plane:
    seq:
      - id: word
        type: u4
    instances:
      size:
        value: word & 0x3fffffff
        doc: Stored bytes.
      codec:
        value: word >> 30
        enum: codec
  stored_column:
    params:
      - id: i
        type: u4
    seq:
      - id: planes
        size: _parent.columns[i].planes[_index].size
        repeat: expr
        repeat-expr: _parent.columns[i].plane_count
  footer:
    seq:
      - id: offset
        type: u8
        doc: Of this footer in the file.
      - id: run_count
        type: u8
      - id: provenance_size
        type: u8
      - id: entries_hash
        size: 8
      - id: provenance_hash
        size: 8
      - id: zero
        type: u8
      - id: head_hash
        size: 8
      - id: entries
        type: run_entry
        repeat: expr
        repeat-expr: run_count
      - id: provenance
        type: str
        size: provenance_size
        encoding: UTF-8
      - id: head_again
        size: 64
  first_footer:
    doc: As version 0.1 wrote it.
    seq:
      - id: run_count
        type: u8
      - id: provenance_size
        type: u8
      - id: entries
        type: first_footer_entry
        repeat: expr
        repeat-expr: run_count
      - id: provenance
        type: str
        size: provenance_size
        encoding: UTF-8
      - id: offset
        type: u8
      - id: size
        type: u8
      - id: footer_hash
        size: 8
      - id: zero
        size: 24
      - id: trailer_hash
        size: 8
      - id: magic_again
        type: magic
  first_footer_entry:
    seq:
      - id: offset
        type: u8
      - id: magic
        type: magic
      - id: entry
        type: run_entry
      - id: zero
        size: 112
      - id: header_hash
        size: 8
enums:
  section_kind:
    0x46: file_header
    0x52: run
    0x49: footer
    0x45: first_footer
  record_kind:
    1: spectral
    2: xyz
  sampler:
    0: none
    1: halton23
    2: pixels
  column_type:
    1: u8
    2: u16
    3: u32
    4: u64
    5: f32
    6: f64
  record_class:
    0: camera
    1: light
  column_number:
    1: sample
    2: u
    3: v
    4: share
    5: x
    6: y
    7: z
    8: pairs
    9: xi
    10: index
    11: power
    12: lambda
  transform:
    0: planes
    1: packed
    2: lattice
    3: sampler
    4: cross
    5: delta2
    6: sparse
    7: sparse_cross
    8: stepped_cross
    9: stepped_delta2
    10: stepped_sparse_cross
    11: packed_delta2
    12: pixels
  codec:
    0: raw
    1: zstd
    2: constant
    3: dictionary
