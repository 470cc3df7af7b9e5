"""From a scene to a plan: a short trial, a size for the tasks, and a prediction."""
import math
import os
import resource
import sys
import time
import typing

from latent_farm import sizing, tools, units
from latent_farm.errors import Failure, Misuse
from latent_farm.names import shown
from latent_farm.plan import Plan


TRIAL_SPP = 16  # at most; more takes longer than a trial, and the whole job may be more than one part can hold
BRIEF = ["--max-time", "0.5"]  # enough for some samples where a machine is busy


class Trial(typing.NamedTuple):
    """What latent-render makes of a scene and its options."""

    samples: int  # of the whole job
    job: str
    run_samples: int
    rate: float  # samples per second of a task
    bytes_per_sample: float


def trial(folder, arguments, spp, cpus):
    """Renders the first samples of a job of `spp` on as many as possible of the `cpus` processors of a task."""
    here = len(os.sched_getaffinity(0))
    threads = min(cpus or here, here)
    answer = tools.forecast([*arguments, "--spp", f"{min(spp, TRIAL_SPP):.17g}", "--threads", str(threads)], folder.parts / "trial.latent")
    if not answer["seconds"] > 0:
        raise Failure("the trial measured nothing; is the scene empty?")
    samples = answer["samples"] if spp <= TRIAL_SPP else math.ceil(spp * (answer["samples"] // TRIAL_SPP))
    if samples >= 1 << 62:
        raise Misuse(f"--spp {spp:g}: too large; a job has fewer than 2^62 samples")
    return Trial(samples, answer["job"], answer["run_samples"], answer["samples"] / answer["seconds"] * (cpus or here) / threads,
                 answer["bytes"] / answer["samples"])


REMEMBERED = ("memory", "cpus", "develop", "strips", "compact", "checkpoint", "print", "fps", "on_done", "until", "engine", "hosts", "sbatch",
              "time", "throttle", "until_noise", "max_spp")


def choose(plan, args):
    """What was asked for on the command line replaces what the plan holds."""
    tools.check_options("--develop", "latent-develop", args.develop or [], "picture.exr")
    tools.check_options("--print", "latent-convert", args.print or [], "picture.png")
    developed, printed = (plan.develop, plan.strips), plan.print
    if args.print is not None or args.fps is not None:
        plan.until = "print"
    for name in REMEMBERED:
        if getattr(args, name) is not None:
            setattr(plan, name, getattr(args, name))
    if (plan.develop, plan.strips) != developed:
        plan.develop_since = time.time()
    if plan.print != printed:
        plan.print_since = time.time()


def make_plan(folder, args, cpus, machines, like=None):
    """Measures and cuts. `folder` has its parts folder. `like`: a plan of a similar scene, which was measured for longer."""
    scene = os.path.abspath(args.scene)
    arguments = [scene, *args.options]
    found = trial(folder, [*arguments, *(BRIEF if like else [])], args.spp, cpus)
    rate = like.rate if like else found.rate
    tasks = args.tasks or sizing.count_tasks(found.samples / rate, machines)
    fixed = any(option.split("=")[0] == "--run-samples" for option in args.options)
    task_samples, run_samples = sizing.cut(found.samples, tasks, found.run_samples, may_shorten=not fixed)
    if run_samples != found.run_samples:  # which makes another job
        found = trial(folder, [*arguments, "--run-samples", str(run_samples), *BRIEF], args.spp, cpus)
    made = math.ceil(found.samples / task_samples)
    if made < args.tasks:
        note(f"--tasks {args.tasks}: there are {units.counted(made, 'task')}, since tasks consist of whole runs, here of {run_samples} samples")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    plan = Plan(scene=scene, spp=args.spp, options=args.options, samples=found.samples, task_samples=task_samples,
                run_samples=run_samples, job=found.job, rate=rate, bytes_per_sample=found.bytes_per_sample,
                memory=max(1 << 30, peak * 3 // 2), machines=machines, cpus=cpus)
    choose(plan, args)
    plan.develop_since = plan.print_since = 0
    plan.check()
    return plan


def extend(folder, plan, args, machines):
    """An existing plan with more samples, or just as it is. The size of tasks and runs stays: parts are there already."""
    if args.scene and os.path.abspath(args.scene) != plan.scene:
        raise Misuse(f"{folder.path}: holds a plan for {plan.scene}; choose another --out")
    if args.options and args.options != plan.options:
        raise Misuse(f"{folder.path}: its plan has other options for latent-render ({' '.join(plan.options) or 'none'}); "
                     "choose another --out")
    same_cut = args.tasks and sizing.cut(plan.samples, args.tasks, plan.run_samples, may_shorten=False)[0] == plan.task_samples
    if args.tasks and not same_cut and (args.spp or plan.spp) == plan.spp:
        raise Misuse(f"{folder.path}: its plan has {plan.tasks} tasks; choose another --out, or leave out --tasks")
    if args.spp and args.spp < plan.spp:
        raise Misuse(f"--spp {args.spp:g}: the plan in {folder.path} has --spp {plan.spp:g}; to use fewer samples, "
                     "develop with --samples")
    choose(plan, args)
    plan.machines = machines or plan.machines
    if args.spp and args.spp > plan.spp:
        found = trial(folder, [plan.scene, *plan.render_options], args.spp, plan.cpus)
        check_job(plan, found.job)
        plan.spp, plan.samples, plan.rate = args.spp, found.samples, found.rate
    plan.check()


def check_scene(folder, plan):
    """That the scene, where tasks of this machine find it, is still the one that was planned."""
    scene = os.environ.get("LATENT_SCENE", plan.scene)
    arguments = [scene, *plan.render_options, "--samples", "0:1"]
    check_job(plan, tools.forecast(arguments, folder.parts / "trial.latent")["job"])


def check_job(plan, job):
    if job != plan.job:
        raise Failure(f"{plan.scene}: has changed since it was planned, so it is another job; choose another --out")


def note(text):
    print(f"latent-farm: {shown(text)}", file=sys.stderr)
