"""From a scene to a plan: a short trial, a size for the tasks, and a prediction."""
import os
import resource
import sys
import time

from latent_farm import sizing, tools
from latent_farm.errors import Failure, Misuse
from latent_farm.plan import Plan, part_name


def trial(folder, arguments, cpus):
    """latent-render's forecast, and samples per second of a task that has `cpus` processors."""
    here = len(os.sched_getaffinity(0))
    threads = min(cpus or here, here)
    answer = tools.forecast([*arguments, "--threads", str(threads)], folder.parts / part_name(99999))
    if not answer["seconds"] > 0:
        raise Failure("the trial measured nothing; is the scene empty?")
    return answer, answer["samples"] / answer["seconds"] * (cpus or here) / threads


def make_plan(folder, args, machines, like=None):
    """Measures and cuts. `folder` has its parts folder. `like`: a plan of a similar scene, which was measured for longer."""
    scene = os.path.abspath(args.scene)
    arguments = [scene, *args.options, "--spp", f"{args.spp:.17g}"]
    brief = ["--max-time", "0.1"]
    answer, rate = trial(folder, [*arguments, *(brief if like else [])], args.cpus)
    tasks = args.tasks or sizing.count_tasks(answer["samples"] / rate, machines)
    fixed = any(option.split("=")[0] == "--run-samples" for option in args.options)
    task_samples, run_samples = sizing.cut(answer["samples"], tasks, answer["run_samples"], may_shorten=not fixed)
    if run_samples != answer["run_samples"]:  # which makes another job
        answer, _ = trial(folder, [*arguments, "--run-samples", str(run_samples), *brief], args.cpus)
    rate = like.rate if like else rate
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    return Plan(scene=scene, spp=args.spp, options=args.options, samples=answer["samples"], task_samples=task_samples,
                run_samples=run_samples, job=answer["job"], rate=rate, bytes_per_sample=answer["bytes"] / answer["samples"],
                memory=args.memory or max(1 << 30, peak * 3 // 2), machines=machines, cpus=args.cpus, develop=args.develop,
                strips=args.strips or 1, compact=args.compact,
                until=args.until or "develop", checkpoint=args.checkpoint or 60)


def extend_plan(folder, plan, args, machines):
    """An existing plan with more samples, or just as it is. The size of tasks and runs stays: parts are there already."""
    if args.scene and os.path.abspath(args.scene) != plan.scene:
        raise Misuse(f"{folder.path}: holds a plan for {plan.scene}; choose another --out")
    if args.options and args.options != plan.options:
        raise Misuse(f"{folder.path}: its plan has other options for latent-render ({' '.join(plan.options) or 'none'}); "
                     "choose another --out")
    if args.tasks and args.tasks != plan.tasks and (args.spp or plan.spp) == plan.spp:
        raise Misuse(f"{folder.path}: its plan has {plan.tasks} tasks; choose another --out, or leave out --tasks")
    if args.spp and args.spp < plan.spp:
        raise Misuse(f"--spp {args.spp:g}: the plan in {folder.path} has --spp {plan.spp:g}; to use fewer samples, "
                     "develop with --samples")
    if args.spp and args.spp > plan.spp:
        arguments = [plan.scene, *plan.render_options, "--spp", f"{args.spp:.17g}"]
        answer, rate = trial(folder, arguments, plan.cpus)
        if answer["job"] != plan.job:
            raise Failure(f"{plan.scene}: has changed since it was planned, so it is another job; choose another --out")
        plan.spp, plan.samples, plan.rate = args.spp, answer["samples"], rate
    if args.cpus:
        plan.cpus = args.cpus
    plan.memory = args.memory or plan.memory
    chosen = args.develop or plan.develop, args.strips or plan.strips
    if chosen != (plan.develop, plan.strips):
        (plan.develop, plan.strips), plan.develop_since = chosen, time.time()
    plan.compact = args.compact or plan.compact
    plan.until = args.until or plan.until
    plan.checkpoint = args.checkpoint or plan.checkpoint
    plan.machines = machines or plan.machines
    return plan


def note(text):
    print(f"latent-farm: {text}", file=sys.stderr)
