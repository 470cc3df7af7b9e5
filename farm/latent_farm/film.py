"""The prints of an animation's frames become a film, by ffmpeg."""
import contextlib
import shutil
import subprocess
import tempfile

from latent_farm import files
from latent_farm.errors import Failure

PNG = b"\x89PNG\r\n\x1a\n"  # how such a file begins


def is_possible():
    return shutil.which("ffmpeg") is not None


def command(fps, output):
    """Pictures come through a pipe, so that ffmpeg interprets no names. Most players want even sizes, 4:2:0, and colours as in BT.709,
    whose primaries are those of sRGB."""
    return ["ffmpeg", "-loglevel", "error", "-xerror", "-y", "-f", "image2pipe", "-framerate", f"{fps:g}", "-c:v", "png", "-i", "-",
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-crf", "16",
            "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-f", "mp4", output]


def copy_png(path, pipe):
    """ffmpeg would skip what is none without a word."""
    try:
        with files.opened(path) as picture:
            if picture.read(len(PNG)) != PNG:
                raise Failure(f"{path}: is not a PNG file; print this frame again")
            picture.seek(0)
            shutil.copyfileobj(picture, pipe)
    except FileNotFoundError:
        raise Failure(f"{path}: no such file; print this frame first") from None


def make(prints, fps, output):
    """One frame from each of `prints`, in their order."""
    if not is_possible():
        raise Failure("ffmpeg: not found; install it, then run the same command again")
    with files.written(output) as film, tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command(fps, f"file:/dev/fd/{film.fileno()}"), stdin=subprocess.PIPE, stdout=said, stderr=said,
                                   pass_fds=[film.fileno()])
        try:
            for path in prints:
                copy_png(path, process.stdin)
        except BrokenPipeError:  # ffmpeg says why
            pass
        except BaseException:
            process.kill()
            raise
        finally:
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
            status = process.wait()
        if status != 0:
            said.seek(0)
            lines = said.read().decode(errors="surrogateescape").strip().splitlines()
            raise Failure(f"{output}: ffmpeg: {lines[-1] if lines else f'ended with status {status}'}")
