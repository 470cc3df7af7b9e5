"""Read, write, merge and develop .latent files: the raw samples of renderings, as NumPy arrays.

Records are columns: arrays of the same length n, one for each property.

    sample       (n,) uint64   sample number
    class        (n,) uint8    0 camera, 1 light
    u, v         (n,) float64  position on the film, 0..1, to the right and downwards
    share        (n,) float32  of the sample's denominator; 0 in light records
    x, y, z      (n,) float32  XYZ jobs: CIE 1931, not normalised
    power        (n, k) float32  spectral jobs: radiance / (k p), p the density of wavelengths in 1/nm
    wavelengths  (n, k) float32  spectral jobs: nm; pairs that a record does not have are 0 in both
    ...          (n,)          the extra columns of the job; extra.NAME if the name is taken

The meaning of the numbers is defined in docs/format.md, "Records". A pixel is sum(value) / sum(share) over its camera records.

Arguments that no call could take raise TypeError, ValueError or KeyError. What goes wrong with files raises latent.Error, an OSError.
"""

from . import _latent
from ._latent import Error
from ._reader import Reader, info, open
from ._tools import LatentWarning, develop, develop_layers, merge
from ._writer import Writer

__all__ = ["Error", "LatentWarning", "Reader", "Writer", "develop", "develop_layers", "info", "merge", "open"]
Error.__doc__ = "What goes wrong with files: one line that says what, where, and what to do."
__version__ = _latent.version()

for _name in __all__:  # where users find them, and what messages call them
    globals()[_name].__module__ = __name__
