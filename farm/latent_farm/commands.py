"""What the commands of latent-farm do."""
import json
import os
import pathlib

from latent_farm import engines, frames, planning, ranges, slurm, strips, units
from latent_farm import status as status_of
from latent_farm.errors import DONE, Failure, Misuse
from latent_farm.names import check_name, shown
from latent_farm.output import output_is_kept, say
from latent_farm.plan import check_render_options
from latent_farm.work import Work


def survey(args):
    """The work of all frames, and what is to be said if it will not fit on the disk."""
    check_render_options(args.options)
    for option in args.options:
        check_name(option, "options must not")
    if args.hosts:
        if args.engine != "parallel":
            raise Misuse("--hosts: needs --engine parallel")
        args.hosts = os.path.abspath(args.hosts)
        check_name(args.hosts)
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
    each = units.format_duration(report["task_seconds"])
    size = f"1 task ({each})" if report["tasks"] == 1 else f"{report['tasks']} tasks of {report['task_samples']} ({each} each)"
    text = f"{units.counted(report['samples'], 'sample')} in {size}, runs of {min(report['samples'], report['run_samples'])}\n"
    if report["missing_samples"]:
        text += (f"missing: {units.counted(report['missing_samples'], 'sample')} of {ranges.tasks_text(report['missing_tasks'])}; about "
                 f"{units.format_duration(report['seconds'])} with {report['machines']} at a time\n")
    text += (f"disk: {units.format_size(report['bytes'])} when finished, {units.format_size(report['free_bytes'])} free\n")
    if not report["steps"]:
        return text + "nothing is left to do" + units.left_out(report) + "\n"
    return text + "\n" + "\n".join(report["commands"]) + "\n"


def show(reports, as_json):
    if as_json:
        say(json.dumps(reports[0] if len(reports) == 1 else reports, indent=2) + "\n")
    else:
        say("\n".join((f"{shown(report['folder'])}: " if len(reports) > 1 else "") + to_text(report) for report in reports))


def engine_of(args):
    """What was asked for, what the plan remembers, or what is here."""
    remembered = [folder.read_plan().engine for folder in frames.planned(args.out)]
    return args.engine or (remembered or ["slurm" if slurm.is_here() else "shell"])[0]


def plan_command(args):
    args.engine = engine_of(args)
    _, reports, too_large = survey(args)
    if too_large:
        planning.note(too_large)
    with output_is_kept():
        show(reports, args.json)
    return DONE


def submit_command(args):
    args.engine = engine_of(args)
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
        report["jobs"] = slurm.Chain(work.folder, work.plan).submit(work.stages)
    with output_is_kept():
        show(reports, args.json)
        jobs = [job for report in reports for job in report["jobs"]]
        if jobs and not args.json:
            say(f"submitted: jobs {', '.join(jobs)}\n")
    return DONE


def resume_command(args):
    frames.existing(args.out)
    return submit_command(args)


def status_command(args):
    say(status_of.status(frames.existing(args.out), args.json, args.stalled_after))
    return DONE


def join_command(args):
    strips.join([pathlib.Path(path) for path in args.strip], pathlib.Path(args.output), args.force)
    return DONE


RUN = {"plan": plan_command, "submit": submit_command, "resume": resume_command, "status": status_command,
       "join": join_command}
