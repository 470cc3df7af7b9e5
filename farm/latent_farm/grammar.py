"""What latent-farm takes on its command line."""
import argparse
import shlex

from latent_farm import units
from latent_farm.help import Command

FORMATS = """TIME is 90, 90s, 10m or 1h30m. SIZE is in bytes, where K, M, G, T are powers of
1024."""
STATUSES = """Exit status: 0 done; 1 failed; 2 wrong usage; 75 interrupted, all finished work
saved: run the same command again to resume."""


def number(least):
    def parse(text):
        if not text.isdigit() or int(text) < least:
            raise argparse.ArgumentTypeError(f"'{text}' is not a number of at least {least}")
        return int(text)
    return parse


def spp(text):
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not 0 < value < 1e15:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of samples per pixel")
    return value


def tasks(text):
    return 0 if text == "auto" else number(1)(text)


def words(text):
    return shlex.split(text)


def add_steps(command):
    """The options that say how steps are run."""
    command.option("--engine", "slurm|parallel|shell", "what runs the tasks (default: slurm if sbatch is installed, else shell)",
                   choices=["slurm", "parallel", "shell"])
    command.option("--hosts", "FILE", "machines for parallel, one per line, as its --sshloginfile takes them")
    command.option("--machines", "N", "tasks that can run at the same time (default: asked of Slurm, else lines of --hosts, else 1)",
                   type=number(1))
    command.option("--cpus", "N", "processors of a task (default: all of a machine)", type=number(1), default=0)
    command.option("--memory", "SIZE", "memory of a task, for Slurm (default: as measured, with half as much again)",
                   type=units.parse_size)
    command.option("--time", "TIME", "time limit of a task, for Slurm; a task that meets it is requeued and resumes "
                   "(default: about twice what is expected)", type=units.parse_duration)
    command.option("--throttle", "N", "tasks of an array that Slurm may run at the same time", type=number(1), default=0)
    command.option("--sbatch", "OPTIONS", "further options of sbatch, such as --sbatch=\"--partition=long\"", type=words, default=[])
    command.option("--develop", "OPTIONS", "options of latent-develop, such as --develop=\"--size 4096\"", type=words, default=[])
    command.option("--checkpoint", "TIME", "interval at which finished work is committed, as for latent-render",
                   type=units.parse_duration, shown_default="60s")
    command.option("--until", "render|merge|develop", "last step", choices=["render", "merge", "develop"], shown_default="develop")
    command.option("--ignore-space", None, "submit even if the files are not expected to fit on the disk")
    command.option("--json", None, "print the report as JSON on standard output")


def add_scene(command, required):
    command.argument("scene", "scene file, as for latent-render; several are the frames of an animation", metavar="SCENE",
                     nargs="+" if required else "*")
    command.option("--out", "DIR", "folder of the plan, its parts and its pictures", required=True)
    command.option("--spp", "N", "samples per pixel, as for latent-render", type=spp)
    command.option("--tasks", "auto|N", "number of tasks", type=tasks, default=0, shown_default="auto")
    add_steps(command)


def make_commands():
    tool = Command("latent-farm", "Render one scene on many machines.", "latent-farm COMMAND", f"""
For help on a command, with examples: latent-farm COMMAND --help

{STATUSES}""")
    rest = "Options after -- are passed on to latent-render."
    plan = Command("latent-farm plan", "Divide a render into tasks, and print how to run them.",
                   "latent-farm plan SCENE... --spp N --out DIR [OPTIONS] [-- RENDER OPTIONS]", f"""
{rest}
{FORMATS}

Measures for a few seconds, predicts time and disk space, and writes scripts
into DIR. Starts nothing. A second time, with a larger --spp, it extends the
plan; finished work stays.

Examples:
  latent-farm plan scene.pbrt --spp 256 --out night
      for the Slurm cluster that this machine belongs to
  latent-farm plan scene.pbrt --spp 256 --out night --engine parallel \\
      --hosts hosts
      for machines that ssh reaches, with GNU parallel
  latent-farm plan scene.pbrt --spp 256 --out night -- --integrator bdpt
      with options of latent-render
  latent-farm plan frame-*.pbrt --spp 64 --out film
      an animation: every frame has its own folder in film

{STATUSES}""")
    add_scene(plan, required=True)
    submit = Command("latent-farm submit", "Plan, and run what is missing.",
                     "latent-farm submit [SCENE...] --out DIR [OPTIONS] [-- RENDER OPTIONS]", f"""
{rest}
{FORMATS}

With Slurm, submits render tasks, merge and develop as jobs that wait for each
other, and returns. With parallel and shell, runs them and waits. Finished tasks
are not submitted again, and those that were interrupted resume.

Examples:
  latent-farm submit scene.pbrt --spp 256 --out night
  latent-farm submit scene.pbrt --spp 512 --out night
      afterwards: as many samples again, and a new picture

{STATUSES}""")
    add_scene(submit, required=False)
    resume = Command("latent-farm resume", "Run what is still missing of a plan.", "latent-farm resume DIR [OPTIONS]", f"""
{FORMATS}

Use it after tasks have failed, or were cancelled. It names what is missing, and
submits only that.

Examples:
  latent-farm resume night
  latent-farm resume night --engine shell
      on this machine

{STATUSES}""")
    resume.argument("out", "folder of the plan", metavar="DIR")
    add_steps(resume)
    status = Command("latent-farm status", "Show what is done, what is missing, and who works.",
                     "latent-farm status DIR [OPTIONS]", f"""
{FORMATS}

Everything is read from the files in DIR, so it works for all engines, and while
they run. A machine's rate and its last commit come from the parts it writes.

Examples:
  latent-farm status night
  latent-farm status night --json

{STATUSES}""")
    status.argument("out", "folder of the plan", metavar="DIR")
    status.option("--stalled-after", "TIME", "how long an unfinished part may stand still", type=units.parse_duration, default=300.0,
                  shown_default="5m")
    status.option("--json", None, "print the report as JSON on standard output")
    tool.commands = {"plan": plan, "submit": submit, "resume": resume, "status": status}
    return tool
