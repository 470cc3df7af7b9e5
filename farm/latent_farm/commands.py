"""What the commands of latent-farm do."""
import json
import os
import pathlib
import sys

from latent_farm import engines, frames, planning, slurm, strips, units
from latent_farm import status as status_of
from latent_farm.errors import DONE, Failure, Misuse
from latent_farm.plan import check_render_options
from latent_farm.work import Work


def survey(args):
    """The work of all frames, and what is to be said if it will not fit on the disk."""
    check_render_options(args.options)
    if args.engine is None:
        args.engine = "slurm" if slurm.is_here() else "shell"
    if args.hosts and args.engine != "parallel":
        raise Misuse("--hosts: needs --engine parallel")
    if args.hosts:
        args.hosts = os.path.abspath(args.hosts)
        if not engines.hosts_in(args.hosts):
            raise Failure(f"{args.hosts}: names no machine; write one per line")
    works, reports = [], []
    found = frames.frames_of(args)
    for folder, own in found:
        works.append(Work(folder, own, works[0].plan if works else None, 1 / len(found)))
        reports.append(works[-1].report())
    needed = sum(max(0, report["bytes_needed"]) for report in reports)
    free = reports[0]["free_bytes"]
    too_large = "" if needed <= free else (f"{args.out}: needs about {units.format_size(needed)} more, but only "
                                           f"{units.format_size(free)} are free")
    return works, reports, too_large


def to_text(report):
    text = (f"{units.counted(report['samples'], 'sample')} in {units.counted(report['tasks'], 'task')} of {report['task_samples']} "
            f"({units.format_duration(report['task_seconds'])} each), runs of {report['run_samples']}\n")
    if report["missing_samples"]:
        tasks = f"task{'' if report['missing_tasks'].isdigit() else 's'} {report['missing_tasks']}"
        text += (f"missing: {units.counted(report['missing_samples'], 'sample')} of {tasks}; about "
                 f"{units.format_duration(report['seconds'])} with {report['machines']} at a time\n")
    text += (f"disk: {units.format_size(report['bytes'])} when finished, {units.format_size(report['free_bytes'])} free\n")
    if not report["steps"]:
        return text + "nothing is left to do" + units.left_out(report) + "\n"
    return text + "\n" + "\n".join(report["commands"]) + "\n"


def show(reports, as_json):
    if as_json:
        print(json.dumps(reports[0] if len(reports) == 1 else reports, indent=2))
    else:
        print("\n".join((f"{report['folder']}: " if len(reports) > 1 else "") + to_text(report) for report in reports), end="")
    sys.stdout.flush()


def plan_command(args):
    _, reports, too_large = survey(args)
    if too_large:
        planning.note(too_large)
    show(reports, args.json)
    return DONE


def submit_command(args):
    engines.check(args.engine)
    for folder in frames.planned(args.out):
        if waiting := slurm.in_queue(folder):
            raise Failure(f"{folder.path}: still in Slurm's queue: {', '.join(waiting[:4])}{' ...' if len(waiting) > 4 else ''}; "
                          "wait for them, or cancel them with scancel")
    works, reports, too_large = survey(args)
    if too_large and not args.ignore_space:
        raise Failure(too_large + "; to submit anyway, use --ignore-space")
    if args.engine != "slurm":
        show(reports, args.json)
        return engines.run([line for work in works for line in work.lines])
    for work, report in zip(works, reports):
        report["jobs"] = work.chain.submit(work.stages)
    show(reports, args.json)
    jobs = [job for report in reports for job in report["jobs"]]
    if jobs and not args.json:
        print(f"submitted: jobs {', '.join(jobs)}")
    return DONE


def resume_command(args):
    frames.existing(args.out)
    return submit_command(args)


def status_command(args):
    print(status_of.status(frames.existing(args.out), args.json, args.stalled_after), end="")
    return DONE


def join_command(args):
    strips.join([pathlib.Path(path) for path in args.strip], pathlib.Path(args.output), args.force)
    return DONE


RUN = {"plan": plan_command, "submit": submit_command, "resume": resume_command, "status": status_command,
       "join": join_command}
