"""XXH3 and zstd, which docs/format.md names and does not define, from the system's own libraries."""
import ctypes

_zstd = ctypes.CDLL("libzstd.so.1")
_zstd.ZSTD_decompress.restype = ctypes.c_size_t
_zstd.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
_zstd.ZSTD_compress.restype = ctypes.c_size_t
_zstd.ZSTD_compress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_int]
_zstd.ZSTD_compressBound.restype = ctypes.c_size_t
_zstd.ZSTD_compressBound.argtypes = [ctypes.c_size_t]
_zstd.ZSTD_findFrameCompressedSize.restype = ctypes.c_size_t
_zstd.ZSTD_findFrameCompressedSize.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
_xxhash = ctypes.CDLL("libxxhash.so.0")


class _Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


_xxhash.XXH3_64bits.restype = ctypes.c_uint64
_xxhash.XXH3_64bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
_xxhash.XXH3_128bits.restype = _Hash128
_xxhash.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]


def hash64(data):
    return _xxhash.XXH3_64bits(bytes(data), len(data))


def hash128(data):
    """(low half, high half), in the order in which they are stored."""
    h = _xxhash.XXH3_128bits(bytes(data), len(data))
    return (h.low, h.high)


def zstd_frame_size(data):
    """Bytes of the frame that `data` begins with; an impossible size if it begins with none."""
    return _zstd.ZSTD_findFrameCompressedSize(bytes(data), len(data))


def zstd_decompress(data, size):
    """The content of one frame, or None if that is not exactly `size` bytes."""
    out = ctypes.create_string_buffer(max(size, 1))
    return out.raw[:size] if _zstd.ZSTD_decompress(out, size, bytes(data), len(data)) == size else None


def zstd_compress(data):
    bound = _zstd.ZSTD_compressBound(len(data))
    out = ctypes.create_string_buffer(bound)
    size = _zstd.ZSTD_compress(out, bound, bytes(data), len(data), 1)
    return out.raw[:size]
