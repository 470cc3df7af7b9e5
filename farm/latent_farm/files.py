"""Files that others may have put there, and files that others may read at any moment."""
import contextlib
import json
import os
import secrets
import stat

from latent_farm.errors import Failure

MOST = 1 << 20  # bytes of a file that is read as a whole


def opened(path):
    """A regular file, for reading. A pipe would keep us waiting. Errors: FileNotFoundError, or a Failure."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return os.fdopen(descriptor, "rb")
        os.close(descriptor)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from None
    raise Failure(f"{path}: is not a regular file")


def read(path):
    """The bytes of a small file."""
    with opened(path) as file:
        try:
            data = file.read(MOST + 1)
        except OSError as error:
            raise Failure(f"{path}: cannot be read: {error.strerror}") from None
    if len(data) > MOST:
        raise Failure(f"{path}: has more than {MOST} bytes")
    return data


def parse_json(data):
    try:
        return json.loads(data)
    except (ValueError, RecursionError):
        raise Failure("not JSON") from None


@contextlib.contextmanager
def written(path, mode=0o666):
    """A new file, open for writing, that appears under its name when it is complete, and takes the place of what had this name."""
    temporary = path.with_name(f".latent-{secrets.token_hex(8)}.tmp")
    try:
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, mode)
        try:
            with os.fdopen(descriptor, "wb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
    except OSError as error:
        raise Failure(f"{path}: cannot be written: {error.strerror}") from None


def write(path, text, mode=0o666):
    with written(path, mode) as file:
        file.write(text.encode())
