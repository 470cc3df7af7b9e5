"""The command line of latent-farm: options and help."""
import argparse
import re
import shlex

from latent_farm import noise, units
from latent_farm.help import Command
from latent_farm.names import check_name
from latent_farm.plan import ENGINES, FPS, MOST_TASKS, STEPS

FORMATS = """Numbers accept K, M, G, T (powers of 1000) and Ki, Mi, Gi, Ti (powers of 1024).
SIZE is in bytes, where K, M, G, T are powers of 1024.
TIME is in seconds, or like 90s, 10m, 1.5h or 1h30m."""
STATUSES = """Exit status: 0 done; 1 failed; 2 wrong usage; 3 done, but the report could not
be written; 75 interrupted, all finished work saved: run the same command again
to resume."""

MOST_FRAMES = 100_000


def number(least, most=MOST_TASKS):
    def parse(text):
        value = units.parse_number(text)
        if value is None or not least <= value < 2**63 or value != int(value):
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number of at least {least}")
        if value > most:
            raise argparse.ArgumentTypeError(f"'{text}' is more than {most}")
        return int(value)
    return parse


def spp(text):
    value = units.parse_number(text)
    if value is None or not 0 < value < 1e15:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of samples per pixel")
    return float(value)


def until_noise(text):
    if noise.target_of(text) is None:
        raise argparse.ArgumentTypeError(f"'{text}' is not a noise (try 2%, or 2%@1920 for a picture 1920 pixels wide)")
    return text


def tasks(text):
    try:
        return 0 if text == "auto" else number(1)(text)
    except argparse.ArgumentTypeError as error:
        raise argparse.ArgumentTypeError(f"{error}, or auto") from None


def words(text):
    try:
        found = shlex.split(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}': {str(error).lower()}") from None
    for word in found:
        check_name(word, "options must not")
    return found


def text(given):
    check_name(given, "options must not")
    return given


def fps(text):
    value = units.parse_number(text)
    if value is None or not FPS[0] <= value <= FPS[1]:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of frames per second")
    return float(value)


def frame_range(text):
    """(first, last), of A:B."""
    ends = [int(end) for end in text.split(":")] if re.fullmatch(r"\d{1,9}:\d{1,9}", text, re.ASCII) else []
    if len(ends) != 2 or not ends[0] <= ends[1] < ends[0] + MOST_FRAMES:
        raise argparse.ArgumentTypeError(f"'{text}' is not a range of up to {MOST_FRAMES} frames, such as 1:120")
    return tuple(ends)


def time_limit(text):
    return 0 if text == "auto" else units.parse_duration(text)


def add_steps(command):
    """The options that say how steps are run. The plan remembers them."""
    command.option("--engine", "slurm|parallel|shell", "scheduler of the tasks (default: slurm if sbatch is installed, else shell)",
                   choices=ENGINES)
    command.option("--hosts", "FILE", "machines for --engine parallel, one per line, in the format of parallel --sshloginfile")
    command.option("--machines", "N", "expected number of concurrent tasks, for their size and the prediction (default: from Slurm or --hosts, else 1)",
                   type=number(1))
    command.option("--cpus", "N", "processors per task; 0: all that a machine has", type=number(0), shown_default="0")
    command.option("--memory", "SIZE", "memory per task, for Slurm (default: 1.5 times the measured memory)",
                   type=units.parse_size)
    command.option("--time", "auto|TIME", "time limit of a task, for Slurm; a task that reaches it is requeued and resumes "
                   "(default: auto, about twice the expected time)", type=time_limit)
    command.option("--throttle", "N", "maximum number of tasks of an array of Slurm that run at once; 0: no limit", type=number(0), shown_default="0")
    command.option("--sbatch", "OPTIONS", "options for sbatch, such as --sbatch=\"--partition=long\"", type=words)
    command.option("--develop", "OPTIONS", "options for latent-develop, such as --develop=\"--size 4096\"", type=words)
    command.option("--strips", "N", "develop the picture in N strips at the same time; needs --develop=\"--size WxH\"", type=number(1),
                   shown_default="1")
    command.option("--compact", None, "merge many small runs into a few large ones, so that crops and strips read less; does not change a finished merge",
                   default=None)
    command.option("--checkpoint", "TIME", "interval at which finished work is committed to disk",
                   type=units.parse_duration, shown_default="60s")
    command.option("--print", "OPTIONS", "print the picture, as picture.png, with these options of latent-convert, such as --print=\"--sensitivity 1.6\"",
                   type=words)
    command.option("--fps", "N", "frames per second of the film that ffmpeg, if installed, makes of the prints of an animation", type=fps, shown_default="24")
    command.option("--on-done", "COMMAND", "command of the shell to run when all is done; $folder is the folder of the plan", type=text)
    command.option("--until", "|".join(STEPS), "last step to run", choices=STEPS, shown_default="develop, or print")
    command.option("--until-noise", "P%[@W]", "add samples until half of the pixels of a picture W pixels wide (default: of --resolution) have a smaller "
                   "relative standard error than P percent", type=until_noise)
    command.option("--max-spp", "N", "samples per pixel after which --until-noise ends in any case", type=spp)
    command.option("--ignore-space", None, "submit even if the files are not expected to fit on the disk")
    command.option("--json", None, "print the report as JSON on standard output")


def add_scene(command, required):
    command.argument("scene", "scene file for latent-render, or several: the frames of an animation", metavar="SCENE",
                     nargs="+" if required else "*")
    command.option("--out", "DIR", "folder of the plan, its parts and its pictures", required=True)
    command.option("--frames", "A:B", "frames A to B of the animation in one glTF scene; frame N shows the moment of N / fps seconds",
                   type=frame_range)
    command.option("--spp", "N", "samples per pixel", type=spp)
    command.option("--tasks", "auto|N", "number of tasks", type=tasks, default=0, shown_default="auto")
    add_steps(command)


def make_commands():
    tool = Command("latent-farm", "Render a scene on many machines.", "latent-farm COMMAND", f"""
For help on a command, with examples: latent-farm COMMAND --help

{STATUSES}""")
    rest = "Options after -- are passed on to latent-render."
    plan = Command("latent-farm plan", "Divide a render into tasks, and print how to run them.",
                   "latent-farm plan SCENE... --spp N --out DIR [OPTIONS] [-- RENDER OPTIONS]", f"""
{rest}
{FORMATS}

Renders for a few seconds to predict time, memory and disk space, then writes
scripts into DIR. No task is started. To extend a plan, run it again with a
larger --spp; finished work is kept.

Examples:
  latent-farm plan scene.pbrt --spp 256 --out night
      plan for the Slurm cluster that this machine belongs to
  latent-farm plan scene.pbrt --spp 256 --out night --engine parallel \\
      --hosts hosts
      plan for GNU parallel, on machines that ssh can reach
  latent-farm plan scene.pbrt --spp 256 --out night -- --integrator bdpt
      pass an option to latent-render
  latent-farm plan scene.pbrt --until-noise 2%@1920 --out night
      as many samples as a clean picture 1920 pixels wide needs
  latent-farm plan frame-*.pbrt --spp 64 --out film
      plan an animation; each frame gets its own folder in film

{STATUSES}""")
    add_scene(plan, required=True)
    submit = Command("latent-farm submit", "Plan a render, and run its missing tasks.",
                     "latent-farm submit [SCENE...] --out DIR [OPTIONS] [-- RENDER OPTIONS]", f"""
{rest}
{FORMATS}

With Slurm, submits the render, merge and develop steps as jobs that depend on
each other, and returns at once. With parallel and shell, runs the steps and
waits. Finished tasks are skipped, and interrupted ones resume.

Examples:
  latent-farm submit scene.pbrt --spp 256 --out night
  latent-farm submit scene.pbrt --spp 512 --out night
      then double the samples, and develop a new picture

{STATUSES}""")
    add_scene(submit, required=False)
    resume = Command("latent-farm resume", "Run the missing tasks of a plan.", "latent-farm resume DIR [OPTIONS]", f"""
{FORMATS}

Use resume when tasks have failed or were cancelled. It lists the missing tasks
and runs only these, then the later steps. The plan remembers all options; one
that you give again replaces the old one.

Examples:
  latent-farm resume night
  latent-farm resume night --engine shell
      run them on this machine

{STATUSES}""")
    resume.argument("out", "folder of the plan", metavar="DIR")
    add_steps(resume)
    status = Command("latent-farm status", "Show progress, missing samples, and active machines.",
                     "latent-farm status DIR [OPTIONS]", f"""
{FORMATS}

Reads only the files in DIR, so it works with every engine, and while tasks run.
The speed and last commit of a machine are taken from the parts it writes, and
why a task failed from its log.

Examples:
  latent-farm status night
  latent-farm status night --json
  latent-farm status night --prometheus >night.prom

{STATUSES}""")
    status.argument("out", "folder of the plan", metavar="DIR")
    status.option("--stalled-after", "TIME", "time without a commit after which a part counts as stalled", type=units.parse_duration, default=300.0,
                  shown_default="5m")
    status.option("--json", None, "print the report as JSON on standard output")
    status.option("--prometheus", None, "print it as metrics for Prometheus, for the textfile collector of its node_exporter")
    noise = Command("latent-farm noise", "Measure the noise of a plan with --until-noise, and run what is left.", "latent-farm noise DIR [OPTIONS]", f"""
{FORMATS}

The step noise of a plan runs this command, when all tasks are finished. If the
picture is noisier than --until-noise asks, it extends the plan and runs the new
tasks; then this step again. Otherwise it runs the later steps.

Examples:
  latent-farm noise night

{STATUSES}""")
    noise.argument("out", "folder of the plan", metavar="DIR")
    add_steps(noise)
    join = Command("latent-farm join", "Join the strips of a picture.", "latent-farm join STRIP... -o FILE.exr [OPTIONS]", f"""
latent-farm submit --strips runs this command. Each STRIP is a picture made by
latent-develop --crop: all columns, from a row that is a multiple of 256 up to
the next strip. Tiles are copied as they are.

Examples:
  latent-farm join strips/*.exr -o picture.exr

{STATUSES}""")
    join.argument("strip", "strips of one picture, in any order", metavar="STRIP", nargs="+")
    join.option("-o,--output", "FILE", "picture to write", required=True)
    join.option("--force", None, "replace an existing output")
    film = Command("latent-farm film", "Make a film of the prints of an animation.", "latent-farm film DIR [OPTIONS]", f"""
latent-farm submit --print runs this command when all frames are printed. It
needs ffmpeg. The frames are in the order of their names, and of numbers in
these.

Examples:
  latent-farm film shots --fps 25 -o shots.mp4

{STATUSES}""")
    film.argument("folder", "folder of the frames", metavar="DIR")
    film.option("--fps", "N", "frames per second", type=fps, default=24.0, shown_default="24")
    film.option("-o,--output", "FILE.mp4", "film to write (default: DIR/film.mp4)")
    film.option("--force", None, "replace an existing output")
    tool.commands = {"plan": plan, "submit": submit, "resume": resume, "status": status, "noise": noise, "join": join, "film": film}
    return tool
