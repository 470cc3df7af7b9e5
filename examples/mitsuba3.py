"""Raw spectral samples of a Mitsuba 3 scene. Usage: mitsuba3.py SCENE.xml NAME.latent [SAMPLES_PER_PIXEL]

In a spectral variant, whose rays carry 4 wavelengths each. `scripts/install peers` installs Mitsuba and a library that it needs:

    PYTHONPATH=build/python DRJIT_LIBLLVM_PATH=/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1 .peers/bin/python examples/mitsuba3.py ...
"""
import hashlib
import pathlib
import sys

import mitsuba as mi
import numpy as np

import latent


def columns(array, k):
    """(n, k), whichever way this version of Dr.Jit would lay it out."""
    return np.stack([np.array(array[i]) for i in range(k)], 1)


mi.set_variant("llvm_ad_spectral")
if len(sys.argv) not in (3, 4):
    sys.exit(__doc__)
path, name = sys.argv[1:3]
spp = int(sys.argv[3]) if len(sys.argv) > 3 else 16
scene = mi.load_file(path)
sensor, integrator = scene.sensors()[0], scene.integrator()
width, height = (int(side) for side in sensor.film().size())
sampler = mi.load_dict({"type": "independent"})

job_id = hashlib.md5(pathlib.Path(path).read_bytes() + mi.__version__.encode()).hexdigest()
with latent.Writer(name, job_id=job_id, samples=(0, width * height * spp), wavelengths=4, aspect=(width, height), light_unit=683) as part:
    for first, end in part.grains():  # 1024 samples: more at once would be faster
        n = end - first
        sampler.seed(first // 1024, n)  # samples are functions of their numbers
        position = sampler.next_2d()
        ray, weight = sensor.sample_ray_differential(0.0, sampler.next_1d(), position, sampler.next_2d())
        radiance, valid, _ = integrator.sample(scene, sampler, ray)
        power = columns(radiance * weight, 4) / 4  # the weight divides by the density of wavelengths; k = 4
        power[~np.array(valid, bool)] = 0
        u, v = columns(position, 2).astype(float).T
        wavelengths = columns(ray.wavelengths, 4)
        order = np.argsort(wavelengths, 1)
        part.submit((first, end), sample=np.arange(first, end), u=u, v=v, power=np.take_along_axis(power, order, 1),
                    wavelengths=np.take_along_axis(wavelengths, order, 1))
