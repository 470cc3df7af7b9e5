"""The footer, in both of its forms, and where to look for it."""
import struct

from native import hash64

from .rules import check, fields, is_provenance, rule


def read_footer(data, at, runs):
    """`runs`: (offset, header) of each."""
    if data[-8:] == b"\x8dLTDBE\r\n":  # the first form
        (offset, size, footer_hash) = fields("QQQ", data, len(data) - 64)
        check(hash64(data[-64:-16]) == fields("Q", data, len(data) - 16)[0] and not any(data[-40:-16]), "trailer")
        check(offset == at and size == len(data) - at and hash64(data[at:-64]) == footer_hash, "footer")
        (count, provenance) = fields("QQ", data, at + 8)
        check(data[at : at + 8] == data[-8:] and count == len(runs) and size == 88 + 264 * count + provenance, "sizes of the footer")
        listed = b"".join(struct.pack("<Q", offset) + header for offset, header in runs)
        check(data[at + 24 : at + 24 + 264 * count] == listed, "the footer lists other runs")
        rule(is_provenance(data[at + 24 + 264 * count : -64], 64), "provenance of the footer")
        return
    head = data[at : at + 64]
    (offset, count, provenance, entries_hash, provenance_hash, zero, head_hash) = fields("QQQQQQQ", head, 8)
    check(head[:8] == b"\x8dLTDBI\r\n" and hash64(head[:56]) == head_hash and zero == 0 and offset == at, "head of the footer")
    check(count <= 2**20 and provenance <= 2**24 and at + 128 + 128 * count + provenance == len(data), "sizes of the footer")
    check(data[-64:] == head, "the footer's two ends differ")
    entries, text = data[at + 64 : at + 64 + 128 * count], data[at + 64 + 128 * count : -64]
    check(hash64(entries) == entries_hash and hash64(text) == provenance_hash, "hashes of the footer")
    check(entries == b"".join(header[8:136] for _, header in runs), "the footer lists other runs")
    rule(is_provenance(text, 64), "provenance of the footer")


def footer_from_end(data):
    """Offset that an intact end of a footer gives for its head, if a footer of its size fits there, or None."""
    end = data[-64:]
    if len(end) < 64:
        return None
    if end[:8] == b"\x8dLTDBI\r\n" and hash64(end[:56]) == fields("Q", end, 56)[0]:
        (offset, count, provenance) = fields("QQQ", end, 8)
        size = 128 + 128 * count + provenance
    elif end[56:] == b"\x8dLTDBE\r\n" and hash64(end[:48]) == fields("Q", end, 48)[0]:
        (offset, size) = fields("QQ", end, 0)
    else:
        return None
    return offset if offset + size == len(data) else None


def begins_footer(data, at):
    head = data[at : at + 64]
    if head[:8] == b"\x8dLTDBI\r\n" and len(head) == 64:
        return hash64(head[:56]) == fields("Q", head, 56)[0] and fields("Q", head, 8)[0] == at
    if head[:8] == b"\x8dLTDBE\r\n" and len(head) >= 24:
        (count, provenance) = fields("QQ", head, 8)
        return 88 + 264 * count + provenance <= 2**30
    return False
