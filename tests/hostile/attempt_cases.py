"""Attempts that a writer finds under the name of its part."""
import struct

from forged import BLOCK, HEADER, empty_run, hash64, hash128, writer
from many_cases import damaged
from write_latent import Job



def attempt_runs(id, spans, change=lambda run: None):
    """Runs without records of a job that only its id is known of."""
    job = Job(id, writer.XYZ)
    runs = []
    for intervals in spans:
        run = empty_run(job, intervals)
        change(run)
        run.rehash_header()
        runs.append(run.data())
    return runs


def attempt_of_pages(id, intervals, count, size, hole=0):
    """A run of pages that all have one entry, of zeros or of a hole in the file."""
    run = empty_run(Job(id, writer.XYZ), intervals)
    entry = struct.pack("<BBHIIIIIQIIQ", 0, 0, 0, 0, 0, 1, 0, 32, 0, size, 0, hash64(bytes(size)))
    index = bytes(run.intervals) + entry * count
    tail = index + bytes(-(HEADER + size * count + len(index)) % BLOCK)
    struct.pack_into("<QQQQQQQ", run.header, 64, count, count, 0, 0, 32 * count, size * count, hash64(tail))
    struct.pack_into("<QQ", run.header, 120, *hash128(entry[:32] * count))
    run.rehash_header()
    return [bytes(run.header), size * count, tail]


GAPS = [(0, 100), (200, 300)]
ATTEMPTS = {
    "resume-sound": lambda id: attempt_runs(id, [[(0, 1024)], [(1024, 2048)]]),
    "resume-whole-of-2^20-pages": lambda id: attempt_of_pages(id, [(0, 1024)], 2**20, 0),
    "resume-whole-of-2^29-bytes": lambda id: attempt_of_pages(id, [(0, 1024)], 2**13, 2**16),
    "resume-checkpoint-of-2^20-pages": lambda id: attempt_of_pages(id, GAPS, 2**20, 0),
    "resume-checkpoint-of-2^29-bytes": lambda id: attempt_of_pages(id, GAPS, 2**13, 2**16),
    "resume-checkpoint-of-2^19-pages": lambda id: attempt_of_pages(id, GAPS, 2**19, 0),
    "resume-many-checkpoints": lambda id: attempt_runs(id, [[(i % 1024, i % 1024 + 1), (1024 - i // 1024, 1024)] for i in range(20000) if i % 1024 < 900]),
    "resume-equal-checkpoints": lambda id: attempt_runs(id, [GAPS] * 20000),
    "resume-damaged": lambda id: [damaged(run, 300) for run in attempt_runs(id, [[(0, 1024)], GAPS] * 1000)],
    "resume-foreign": lambda id: attempt_runs((1, 2), [[(0, 1024)], GAPS] * 1000),
    "resume-across-intervals": lambda id: attempt_runs(id, [[(i, 2**40 - i)] for i in range(2000)]),
    "resume-end-of-numbers": lambda id: attempt_runs(id, [[(2**64 - 1024 * i - 2, 2**64 - 2)] for i in range(1, 2000)]),
}


def make_attempt(name, sound):
    """Behind the header of a sound file of the job."""
    (copy_size,) = struct.unpack_from("<I", sound, 12)
    return [sound[: 2 * copy_size], *ATTEMPTS[name](struct.unpack_from("<QQ", sound, 64))]
