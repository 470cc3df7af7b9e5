"""A run: its header, its index, and the order and cut of its pages."""
import struct

from native import hash64, hash128

from .page import decode_page
from .rules import check, fields, rule


def z_prefix(u, v):
    spread = lambda x: sum((x >> i & 1) << 2 * i for i in range(16))
    return spread(v >> 16) << 1 | spread(u >> 16)


def page_end(prefixes, begin, most):
    """Where the page ends that begins at `begin`: it needs more bits than it shares with the record before, and with the one too many."""
    outside = ([prefixes[begin - 1]] if begin > 0 else []) + prefixes[begin + most : begin + most + 1]
    bits = max([33 - (prefixes[begin] ^ other).bit_length() for other in outside], default=0)
    inside = [z >> 32 - min(bits, 32) == prefixes[begin] >> 32 - min(bits, 32) for z in prefixes[begin : begin + most]]
    return begin + (inside + [False]).index(False)


def smallest_square(us, vs):
    different = 0
    for u, v in zip(us, vs):
        different |= u ^ us[0] | v ^ vs[0]
    level = min(16, 32 - different.bit_length())
    return level, us[0] >> 32 - level, vs[0] >> 32 - level


def run_size(header):
    """In every version of the format."""
    (intervals, pages, pages_size) = fields("I", header, 12) + fields("Q", header, 64) + fields("Q", header, 104)
    return (256 + pages_size + 16 * intervals + 48 * pages + 4095) // 4096 * 4096


def check_run_header(job, header):
    check(header[:8] == b"\x8dLTDBR\r\n" and hash64(header[:248]) == fields("Q", header, 248)[0], "run header")
    (major, _, intervals, features, low, high, first, end, samples, pages) = fields("HHIQQQQQQQ", header, 8)
    (light, pairs) = fields("QQ", header, 80)
    check(major == 1 and features == 0 and [low, high] == job.id, "run of another format or job")
    check(not any(header[136:248]), "zeros of the run header")
    check(1 <= intervals <= 2**16 and pages <= 2**20, "intervals or pages of a run")
    check(first < end < 2**64 and 0 < samples <= end - first and (samples == end - first) == (intervals == 1), "samples of a run")
    check(light == 0 or job.light_paths > 0, "light records in a job without light paths")
    check(pairs == 0 or job.kind == 1, "pairs in an XYZ job")


def read_run(job, data, at):
    header = data[at : at + 256]
    check_run_header(job, header)
    (intervals, first, end, samples, pages) = fields("I", header, 12) + fields("QQQQ", header, 40)
    (camera, light, pairs, decoded_size, pages_size, index_hash, *content) = fields("QQQQQQQQ", header, 72)
    index_at = at + 256 + pages_size
    index_size = 16 * intervals + 48 * pages
    size = run_size(header)
    check(at + size <= len(data), "the file ends inside a run")
    check(hash64(data[index_at : at + size]) == index_hash, "index hash")
    check(not any(data[index_at + index_size : at + size]), "padding of the run")
    ranges = [fields("QQ", data, index_at + 16 * i) for i in range(intervals)]
    check((ranges[0][0], ranges[-1][1]) == (first, end) and sum(e - f for f, e in ranges) == samples, "coverage")
    check(all(f < e for f, e in ranges) and all(a[1] < b[0] for a, b in zip(ranges, ranges[1:])), "intervals of the coverage")
    entries_at = index_at + 16 * intervals
    entries = [data[entries_at + 48 * i : entries_at + 48 * i + 48] for i in range(pages)]
    check(hash128(b"".join(e[:32] for e in entries)) == tuple(content), "content hash of the run")

    page_at, sizes, decoded_pages, last = at + 256, ([], []), [], (0, 0, 0)
    prefixes, shares, page_classes = ([], []), {}, 0
    for entry in entries:
        (level, kind, zero, x, y, records, page_pairs, decoded, page_hash, stored, zero2, stored_hash) = fields("BBHIIIIIQIIQ", entry, 0)
        check((zero, zero2) == (0, 0) and kind in (0, 1) and 1 <= records <= job.most_records(), "entry of a page")
        check(level <= 16 and x < 2**level and y < 2**level and page_pairs <= records * job.k, "entry of a page")
        check(decoded <= 2**21 and stored <= decoded + 2**16, "sizes of a page")
        check(page_classes <= kind, "a camera page behind a light page")
        page_classes = kind
        page = data[page_at : page_at + stored]
        page_at += stored
        check(hash64(page) == stored_hash, "page hash")
        columns = decode_page(job, page, (level, x, y), kind == 0, records, page_pairs, page_hash)
        check(sum((page_pairs if c in (11, 12) else records) * w for c, w in job.columns(kind == 0)) == decoded, "decoded size")
        check(all((u >> 32 - level, v >> 32 - level) == (x, y) for u, v in zip(columns[2], columns[3])), "a record outside its square")
        rule((level, x, y) == smallest_square(columns[2], columns[3]), "not the smallest square of the page's records")
        for n, u, v in zip(columns[1], columns[2], columns[3]):
            check(any(f <= n < e for f, e in ranges), "a record outside the coverage")
            place = (kind, z_prefix(u, v), n)
            rule(last <= place, "order of records")
            last = place
            prefixes[kind].append(place[1])
        for n, share in zip(columns[1], columns.get(4, [])):
            shares[n] = shares.get(n, 0) + fields("f", struct.pack("<I", share), 0)[0]
        sizes[kind].append(records)
        decoded_pages.append((kind, columns, decoded, page_pairs))
    check((sum(sizes[0]), sum(sizes[1])) == (camera, light) and page_at == index_at, "the pages do not add up")
    check(sum(p[2] for p in decoded_pages) == decoded_size and sum(p[3] for p in decoded_pages) == pairs, "sums of the run header")
    for kind in (0, 1):
        begin = 0
        for records in sizes[kind]:
            rule(begin + records == page_end(prefixes[kind], begin, job.most_records()), "the page cut")
            begin += records
    rule(all(abs(share - 1) <= 2**-12 for share in shares.values()), "shares of a sample")
    return size, camera, light, ranges, decoded_pages
