"""Builds the wheel that pip asks for (PEP 517) with CMake, in build-wheel beside the sources, or of what was built already:

    pip wheel ./python -w out --no-deps [--config-settings build=FOLDER]
"""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

TREE = pathlib.Path(__file__).resolve().parent.parent
DATE = (1980, 1, 1, 0, 0, 0)  # the same wheel from the same sources


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("latent is built from its source tree: pip wheel ./python")


def version():
    return re.search(r"project\(latent VERSION ([\d.]+)", (TREE / "CMakeLists.txt").read_text())[1]


def run(*command):
    subprocess.run(list(map(str, command)), check=True, stdout=sys.stderr)


def installed(build, folder):
    """The module, somewhere below `folder`."""
    if build is None:
        build = TREE / "build-wheel"
        run("cmake", "-S", TREE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DLATENT_TESTS=OFF", "-DLATENT_PYTHON=ON",
            f"-DLATENT_PYTHON_EXECUTABLE={sys.executable}")
        run("cmake", "--build", build, "--target", "latent_python")
    run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", folder)
    return next(pathlib.Path(folder).rglob("latent/__init__.py")).parent


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    info = f"latent-{version()}.dist-info"
    name = f"latent-{version()}-{tag}.whl"
    record = []
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(os.path.join(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:

        def add(path, data, mode=0o644):
            entry = zipfile.ZipInfo(path, DATE)
            entry.external_attr = mode << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(data)}")

        for path in sorted(installed((config_settings or {}).get("build"), folder).iterdir()):
            add(f"latent/{path.name}", path.read_bytes(), 0o755 if path.suffix == ".so" else 0o644)
        add(f"{info}/METADATA", (
            f"Metadata-Version: 2.1\nName: latent\nVersion: {version()}\n"
            "Summary: Read, write, merge and develop .latent files, the raw samples of renderings, as NumPy arrays\n"
            "License: Apache-2.0\nRequires-Python: >=3.9\nRequires-Dist: numpy\n").encode())
        add(f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: latent\nRoot-Is-Purelib: false\nTag: {tag}\n".encode())
        add(f"{info}/LICENSE", (TREE / "LICENSE").read_bytes())
        record.append(f"{info}/RECORD,,\n")
        wheel.writestr(zipfile.ZipInfo(f"{info}/RECORD", DATE), "\n".join(record))
    return name
