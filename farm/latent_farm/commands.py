"""What the commands of latent-farm do."""
import json
import os
import re
import sys

from latent_farm import engines, planning, ranges, scripts, slurm, state, units
from latent_farm import status as status_of
from latent_farm.errors import DONE, Failure, Misuse
from latent_farm.plan import Folder, check_render_options


def prepare(args):
    """The folder and its plan: made, extended, or as it was."""
    folder = Folder(args.out)
    check_render_options(args.options)
    if args.engine is None:
        args.engine = "slurm" if slurm.is_here() else "shell"
    if args.hosts and args.engine != "parallel":
        raise Misuse("--hosts: is only for --engine parallel")
    nodes = slurm.nodes() if args.engine == "slurm" else []
    if folder.has_plan():
        folder.make()
        plan = planning.extend_plan(folder, folder.read_plan(), args, args.machines)
    elif args.scene and args.spp:
        if not args.cpus and nodes:
            args.cpus = min(cpus for _, cpus in nodes)
        with folder.made():
            plan = planning.make_plan(folder, args, args.machines or count_machines(args, nodes))
    else:
        raise Misuse(f"{folder.path}: holds no plan yet; name a scene and --spp")
    folder.write_plan(plan)
    name = re.sub(r"[^\w.-]", "_", os.path.splitext(os.path.basename(plan.scene))[0])
    scripts.write_scripts(folder, plan, name, minutes=args.time and max(1, round(args.time / 60)))
    return folder, plan


def count_machines(args, nodes):
    if args.engine == "slurm":
        return max(1, sum(count * (cpus // max(1, args.cpus)) for count, cpus in nodes))
    return len(engines.hosts_in(args.hosts)) if args.hosts else 1


def lines_of(folder, plan, args, missing, steps):
    if not missing and not steps:
        return []
    if args.engine == "slurm":
        return list(slurm.Chain(folder, plan, args.sbatch, args.throttle).lines(missing, steps))
    if args.engine == "parallel":
        return engines.parallel_lines(folder, missing, steps, args.hosts)
    return engines.shell_lines(folder, missing, steps)


def report_of(folder, plan, found, missing, steps, lines):
    machines = max(1, plan.machines)
    left = sum(ranges.size(ranges.missing(plan.range_of(task), found.held_by(task))) for task in missing)
    parts = plan.bytes
    return {"folder": str(folder.path), "job": plan.job, "samples": plan.samples, "tasks": plan.tasks,
            "task_samples": plan.task_samples, "task_seconds": plan.task_seconds, "run_samples": plan.run_samples,
            "machines": machines, "samples_per_second": plan.rate, "missing_tasks": ranges.array_list(missing),
            "missing_samples": left, "seconds": left / plan.rate / min(machines, max(1, len(missing))),
            "bytes": parts * (1 if plan.until == "render" else 2), "free_bytes": found.free,
            "fits": parts * (1 if plan.until == "render" else 2) - found.disk <= found.free,
            "steps": (["render"] if missing else []) + steps, "commands": lines}


def to_text(report):
    text = (f"{report['samples']} samples in {report['tasks']} tasks of {report['task_samples']} "
            f"({units.format_duration(report['task_seconds'])} each), runs of {report['run_samples']}\n")
    if report["missing_samples"]:
        text += (f"{report['missing_samples']} samples are missing, tasks {report['missing_tasks']}; about "
                 f"{units.format_duration(report['seconds'])} with {report['machines']} at a time\n")
    text += (f"disk: {units.format_size(report['bytes'])} when finished, {units.format_size(report['free_bytes'])} free\n")
    if not report["steps"]:
        return text + "nothing is left to do\n"
    return text + "\n" + "\n".join(report["commands"]) + "\n"


def survey(args):
    folder, plan = prepare(args)
    found = state.read_state(folder, plan)
    missing = state.unfinished(plan, found)
    steps = state.steps_left(folder, plan, found, missing)
    lines = lines_of(folder, plan, args, missing, steps)
    return folder, plan, missing, steps, lines, report_of(folder, plan, found, missing, steps, lines)


def show(report, as_json):
    print(json.dumps(report, indent=2) if as_json else to_text(report), end="\n" if as_json else "")
    sys.stdout.flush()


def plan_command(args):
    report = survey(args)[-1]
    if not report["fits"]:
        planning.note(too_large(report))
    show(report, args.json)
    return DONE


def too_large(report):
    return (f"{report['folder']}: needs about {units.format_size(report['bytes'])}, but only "
            f"{units.format_size(report['free_bytes'])} are free")


def submit_command(args):
    if Folder(args.out).has_plan() and (waiting := slurm.in_queue(Folder(args.out))):
        raise Failure(f"{args.out}: still in Slurm's queue: {', '.join(waiting[:4])}{' ...' if len(waiting) > 4 else ''}; "
                      "wait for them, or cancel them with scancel")
    folder, plan, missing, steps, lines, report = survey(args)
    if not report["fits"] and not args.ignore_space:
        raise Failure(too_large(report) + "; to submit anyway, use --ignore-space")
    if args.engine == "slurm" and report["steps"]:
        report["jobs"] = slurm.Chain(folder, plan, args.sbatch, args.throttle).submit(missing, steps)
    show(report, args.json)
    if args.engine == "slurm" and report["steps"]:
        if not args.json:
            print(f"submitted: jobs {', '.join(report['jobs'])}")
        return DONE
    return engines.run(lines)


def resume_command(args):
    if not Folder(args.out).has_plan():
        raise Failure(f"{args.out}: holds no plan; make one with latent-farm plan")
    return submit_command(args)


def status_command(args):
    print(status_of.status(Folder(args.out), args.json, args.stalled_after), end="")
    return DONE


RUN = {"plan": plan_command, "submit": submit_command, "resume": resume_command, "status": status_command}
