"""What the commands of latent-farm do."""
import json
import os
import re
import sys

from latent_farm import engines, planning, ranges, scripts, slurm, state, units
from latent_farm import frames as frames_module
from latent_farm import status as status_of
from latent_farm.errors import DONE, Failure, Misuse
from latent_farm.frames import frames_of
from latent_farm.plan import check_render_options


def check(args):
    """What can be said before anything is done, for all frames."""
    check_render_options(args.options)
    if args.engine is None:
        args.engine = "slurm" if slurm.is_here() else "shell"
    if args.hosts and args.engine != "parallel":
        raise Misuse("--hosts: is only for --engine parallel")


def prepare(folder, args, like, share):
    """The plan of a folder: made, extended, or as it was. `like`: a plan of another frame, whose rate stands for this one's;
    `share`: of the machines."""
    nodes = slurm.nodes() if args.engine == "slurm" else []
    if folder.has_plan():
        folder.make()
        plan = planning.extend_plan(folder, folder.read_plan(), args, args.machines)
    elif args.scene and args.spp:
        if not args.cpus and nodes:
            args.cpus = min(cpus for _, cpus in nodes)
        machines = max(1, round((args.machines or count_machines(args, nodes)) * share))
        with folder.made():
            plan = planning.make_plan(folder, args, machines, like)
    else:
        raise Misuse(f"{folder.path}: holds no plan yet; name a scene and --spp")
    folder.write_plan(plan)
    name = re.sub(r"[^\w.-]", "_", os.path.splitext(os.path.basename(plan.scene))[0])
    scripts.write_scripts(folder, plan, name, minutes=args.time and max(1, round(args.time / 60)))
    return plan


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
    whole = plan.bytes * (1 if plan.until == "render" else 2)
    return {"folder": str(folder.path), "job": plan.job, "samples": plan.samples, "tasks": plan.tasks,
            "task_samples": plan.task_samples, "task_seconds": plan.task_seconds, "run_samples": plan.run_samples,
            "machines": machines, "samples_per_second": plan.rate, "missing_tasks": ranges.array_list(missing),
            "missing_samples": left, "seconds": left / plan.rate / min(machines, max(1, len(missing))),
            "bytes": whole, "bytes_needed": whole - found.disk, "free_bytes": found.free, "fits": whole - found.disk <= found.free,
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


class Frame:
    """A folder, its plan, and what is still to be done of it."""

    def __init__(self, folder, args, like, share):
        self.folder, self.plan = folder, prepare(folder, args, like, share)
        found = state.read_state(folder, self.plan)
        self.missing = state.unfinished(self.plan, found)
        self.steps = state.steps_left(folder, self.plan, found, self.missing)
        self.lines = lines_of(folder, self.plan, args, self.missing, self.steps)
        self.report = report_of(folder, self.plan, found, self.missing, self.steps, self.lines)

    def has_work(self):
        return bool(self.missing or self.steps)

    def submit(self, args):
        self.report["jobs"] = slurm.Chain(self.folder, self.plan, args.sbatch, args.throttle).submit(self.missing, self.steps)


def survey(args):
    check(args)
    frames = []
    found = frames_of(args)
    for folder, own in found:
        frames.append(Frame(folder, own, frames[0].plan if frames else None, 1 / len(found)))
    needed = sum(max(0, frame.report["bytes_needed"]) for frame in frames)
    free = frames[0].report["free_bytes"]
    too_large = "" if needed <= free else (f"{args.out}: needs about {units.format_size(needed)} more, but only "
                                           f"{units.format_size(free)} are free")
    return frames, too_large


def show(frames, as_json):
    reports = [frame.report for frame in frames]
    if as_json:
        print(json.dumps(reports[0] if len(reports) == 1 else reports, indent=2))
    else:
        print("\n".join((f"{report['folder']}: " if len(reports) > 1 else "") + to_text(report) for report in reports), end="")
    sys.stdout.flush()


def plan_command(args):
    frames, too_large = survey(args)
    if too_large:
        planning.note(too_large)
    show(frames, args.json)
    return DONE


def submit_command(args):
    for folder in frames_module.planned(args.out):
        if waiting := slurm.in_queue(folder):
            raise Failure(f"{folder.path}: still in Slurm's queue: {', '.join(waiting[:4])}{' ...' if len(waiting) > 4 else ''}; "
                          "wait for them, or cancel them with scancel")
    frames, too_large = survey(args)
    if too_large and not args.ignore_space:
        raise Failure(too_large + "; to submit anyway, use --ignore-space")
    working = [frame for frame in frames if frame.has_work()]
    if args.engine == "slurm":
        for frame in working:
            frame.submit(args)
    show(frames, args.json)
    if args.engine == "slurm":
        if working and not args.json:
            print(f"submitted: jobs {', '.join(job for frame in working for job in frame.report['jobs'])}")
        return DONE
    return engines.run([line for frame in working for line in frame.lines])


def resume_command(args):
    frames_module.existing(args.out)
    return submit_command(args)


def status_command(args):
    print(status_of.status(frames_module.existing(args.out), args.json, args.stalled_after), end="")
    return DONE


RUN = {"plan": plan_command, "submit": submit_command, "resume": resume_command, "status": status_command}
