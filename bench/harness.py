"""What the benches share: building, running a command for its cost, and one table of figures."""
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = ROOT / "build" / "bin"


def say(text):
    print(text, file=sys.stderr, flush=True)


def build(*targets):
    """Installs what is missing and builds `targets` in Release."""
    subprocess.run([ROOT / "scripts/install", "bench"], check=True)
    subprocess.run(["cmake", "--preset", "release", "-DLATENT_TESTS=ON", "-DLATENT_BENCHES=ON"], cwd=ROOT, check=True, stdout=sys.stderr)
    subprocess.run(["cmake", "--build", "--preset", "release", "--target", *targets], cwd=ROOT, check=True, stdout=sys.stderr)


class Cost:
    """Wall and CPU seconds, peak resident MiB, bytes read from disks, and standard output of one command.

    Time and reads are wait4's, with all threads and children. The peak is GNU time's, for a process begins with the peak of the one that
    started it, and Python's is larger than that of some tools.
    """

    def __init__(self, command, env=None, statuses=(0,)):
        command = [str(word) for word in command]
        with tempfile.NamedTemporaryFile("r") as peak_kib:
            begin = time.monotonic()
            child = subprocess.Popen(["/usr/bin/time", "--quiet", "-f", "%M", "-o", peak_kib.name, *command], stdout=subprocess.PIPE,
                                     env={**os.environ, **(env or {})})
            self.out = child.stdout.read().decode()
            _, status, usage = os.wait4(child.pid, 0)
            self.wall = time.monotonic() - begin
            self.mib = int(peak_kib.read()) / 1024
        child.returncode = os.waitstatus_to_exitcode(status)
        self.cpu = usage.ru_utime + usage.ru_stime
        self.disk_bytes = usage.ru_inblock * 512
        if child.returncode not in statuses:
            raise SystemExit(f"exit status {child.returncode}: {' '.join(command)}")

    def json(self):
        return json.loads(self.out)


def tool(verb, *arguments, **options):
    """Runs latent-VERB."""
    return Cost([BIN / f"latent-{verb}", *arguments], **options)


def in_turn(rounds, *commands):
    """Runs each of `commands` (functions that return a Cost) once per round, one after another: a list of Costs for each."""
    return list(zip(*[[command() for command in commands] for _ in range(rounds)]))


def cpu(costs):
    return statistics.median(cost.cpu for cost in costs)


def wall(costs):
    return statistics.median(cost.wall for cost in costs)


def peak(costs):
    return max(cost.mib for cost in costs)


def ratios(costs, peers, of="wall"):
    """Cost over peer, pair by pair."""
    return [getattr(cost, of) / getattr(peer, of) for cost, peer in zip(costs, peers)]


def flush():
    """What earlier steps wrote must not be written to disk during the next."""
    os.sync()


def into_page_cache(*files):
    for path in files:
        with open(path, "rb", buffering=0) as file:
            while file.read(1 << 24):
                pass


def out_of_page_cache(*files):
    flush()
    for path in files:
        with open(path, "rb") as file:
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def need_space(folder, size):
    """Ends the program unless `folder` has room for `size` bytes."""
    free = shutil.disk_usage(folder).free
    if free < size:
        raise SystemExit(f"{folder}: {free >> 30} GiB are free, {-(-size >> 30)} GiB are needed")


class Table:
    """Rows of: what, value (median) with its range, what is asked of it and whether it is met, the inputs of the ratio."""

    def __init__(self):
        self.rows = []

    def add(self, what, values, unit="", at_least=None, at_most=None, how=""):
        values = values if isinstance(values, (list, tuple)) else [values]
        value = statistics.median(values)
        met = None
        if at_least is not None:
            met = value >= at_least
        if at_most is not None:
            met = value <= at_most
        asked = f">= {at_least:g}" if at_least is not None else f"<= {at_most:g}" if at_most is not None else ""
        self.rows.append({"what": what, "value": value, "least": min(values), "most": max(values), "unit": unit, "asked": asked,
                          "met": met, "how": how})

    def print(self, as_json, **heading):
        if as_json:
            print(json.dumps({**heading, "rows": self.rows}, indent=2))
            return
        print("; ".join(f"{name} {value}" for name, value in heading.items()))
        print("| what | measured | range | asked | | how |\n|---|---:|---:|---:|---|---|")
        for row in self.rows:
            spread = f"{row['least']:.3g}..{row['most']:.3g}" if row["least"] != row["most"] else ""
            verdict = {True: "met", False: "**missed**", None: ""}[row["met"]]
            print(f"| {row['what']} | {number(row['value'])} {row['unit']} | {spread} | {row['asked']} | {verdict} | {row['how']} |")


def number(value):
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    memory = int(next(line.split()[1] for line in open("/proc/meminfo") if line.startswith("MemTotal"))) / 2**20
    load = os.getloadavg()[0]
    return f"{os.cpu_count()} x {model}, {memory:.0f} GiB, load {load:.1f}"


def pixels(path):
    """The channels of each pixel of a small picture, by oiiotool."""
    text = subprocess.run(["oiiotool", "--dumpdata", path], check=True, capture_output=True, text=True).stdout
    return [[float(v) for v in line.split(":")[1].split()] for line in text.splitlines() if "Pixel (" in line]


def printed(tools, exposures, paper, film, sensitivity=1):
    """X, Y, Z of each pixel of a picture of exposures of a film on paper, white being (1, 1, 1)."""
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/print.exr"
        subprocess.run([f"{tools}/latent-convert", exposures, "-o", out, "--film", film, "--paper", paper, "-s", str(sensitivity),
                        "--profile", "1,0,0,0,1,0,0,0,1", "-q"], check=True, stdout=subprocess.DEVNULL)
        return pixels(out)


def printed_exposures(tools, exposures, paper, film, index, sensitivity=1):
    """The same of exposures [lux s] of the layers, three for each pixel. `film`: its name, exposed at this index."""
    create = ["oiiotool", "--create", f"{len(exposures)}x1", "3"]
    for i, exposure in enumerate(exposures):
        create += ["--fill:color=" + ",".join(f"{v:.9g}" for v in exposure), f"1x1+{i}+0"]
    for key, value in ("latentFilm", film), ("latentExposureIndex", index), ("latentPush", 0):
        create += ["--attrib:type=string", key, str(value)]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*create, "-d", "float", "-o", f"{folder}/in.exr"], check=True)
        return printed(tools, f"{folder}/in.exr", paper, film, sensitivity)
