"""What latent-farm says on standard output."""
import contextlib
import sys

from latent_farm.errors import Failure, LOSSES


def say(text):
    """Errors: a Failure if it does not arrive."""
    try:
        if sys.stdout is None:
            raise OSError(9, "Bad file descriptor")
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        sys.stdout = None  # Python would try once more when it ends
        raise Failure(f"standard output: cannot write: {error.strerror}") from None


@contextlib.contextmanager
def output_is_kept():
    """For what is said about work that is done already."""
    try:
        yield
    except Failure as error:
        raise Failure(str(error), LOSSES) from None
