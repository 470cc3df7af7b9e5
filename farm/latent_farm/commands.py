"""What the commands of latent-farm do."""
import json
import os
import pathlib

from latent_farm import engines, film, frames, noise, planning, ranges, slurm, state, strips, units
from latent_farm import status as status_of
from latent_farm.errors import DONE, Failure, Misuse
from latent_farm.folder import Folder
from latent_farm.names import check_name, shown
from latent_farm.output import output_is_kept, say
from latent_farm.plan import check_render_options, with_absolute_names
from latent_farm.prometheus import to_prometheus
from latent_farm.work import Works


def survey(args):
    """The work of all frames, and what is to be said if it will not fit on the disk."""
    check_render_options(args.options)
    args.options = with_absolute_names(args.options)
    for option in args.options:
        check_name(option, "options must not")
    if args.hosts:
        if args.engine != "parallel":
            raise Misuse("--hosts: needs --engine parallel")
        args.hosts = os.path.abspath(args.hosts)
        check_name(args.hosts)
        engines.hosts_in(args.hosts)
    works = Works(args)
    for plan in (frame.plan for frame in works.frames):
        if plan.engine == "parallel" and plan.hosts:
            engines.hosts_in(plan.hosts)  # may have become anything since it was planned
    report = works.report()
    if len(works.frames) > 1 and works.plan.until == "print":
        if works.plan.prints_by_auto_exposure:
            planning.note('each frame is printed at an exposure of its own, so the film may flicker; give all the same: '
                          '--print="--sensitivity 1.6"')
        if not film.is_possible():
            planning.note(f"ffmpeg: not found, so there will be prints but no film; install it, then run latent-farm film {shown(args.out)}")
    too_large = "" if report["fits"] else (f"{args.out}: needs about {units.format_size(report['bytes_needed'])} more, but only "
                                           f"{units.format_size(report['free_bytes'])} are free")
    return works, report, too_large


def to_text(report, free):
    each = units.format_duration(report["task_seconds"])
    size = f"1 task ({each})" if report["tasks"] == 1 else f"{report['tasks']} tasks of up to {report['task_samples']} ({each} each)"
    text = f"{units.counted(report['samples'], 'sample')} in {size}, runs of {min(report['samples'], report['run_samples'])}\n"
    if report["missing_samples"]:
        text += (f"missing: {units.counted(report['missing_samples'], 'sample')} of {ranges.tasks_text(report['missing_tasks'])}; about "
                 f"{units.format_duration(report['seconds'])} with {report['at_a_time']} at a time\n")
    text += (f"disk: {units.format_size(report['bytes'])} when finished, {units.format_size(free)} free\n")
    if not report["steps"]:
        return text + "nothing is left to do" + units.left_out(report) + "\n"
    return text + "\n" + "\n".join(report["commands"]) + "\n"


def show(report, as_json):
    if as_json:
        return say(json.dumps(report, indent=2) + "\n")
    several = len(report["frames"]) > 1
    texts = [(f"{shown(frame['folder'])}: " if several else "") + to_text(frame, report["free_bytes"]) for frame in report["frames"]]
    last = report["commands"][sum(len(frame["commands"]) for frame in report["frames"]):]
    say("\n".join([*texts, "".join(line + "\n" for line in last)] if last else texts))


def engine_of(args):
    """What was asked for, what the plan remembers, or what is here."""
    remembered = [folder.read_plan().engine for folder in frames.planned(args.out)[:1]]
    return args.engine or (remembered or ["slurm" if slurm.is_here() else "shell"])[0]


def plan_command(args):
    args.engine = engine_of(args)
    _, report, too_large = survey(args)
    if too_large:
        planning.note(too_large)
    with output_is_kept():
        show(report, args.json)
    return DONE


def submit_command(args):
    args.engine = engine_of(args)
    engines.check(args.engine)
    for folder in [Folder(args.out), *frames.planned(args.out)]:
        if waiting := slurm.in_queue(folder):
            raise Failure(f"{folder.path}: still in Slurm's queue: {', '.join(waiting[:4])}{' ...' if len(waiting) > 4 else ''}; "
                          "wait for them, or cancel them with scancel")
    works, report, too_large = survey(args)
    if too_large and not args.ignore_space:
        raise Failure(too_large + "; to submit anyway, use --ignore-space")
    if args.engine != "slurm":
        show(report, args.json)
        return works.run()
    numbers = works.submit()
    for frame, jobs in zip(report["frames"], numbers):
        frame["jobs"] = jobs
    report["jobs"] = [number for jobs in numbers for number in jobs]
    with output_is_kept():
        show(report, args.json)
        if report["jobs"] and not args.json:
            say(f"submitted: jobs {', '.join(report['jobs'])}\n")
    return DONE


def resume_command(args):
    frames.existing(args.out)
    return submit_command(args)


def status_command(args):
    report, now = status_of.status(Folder(args.out), frames.existing(args.out), args.stalled_after)
    if args.json:
        say(json.dumps(report, indent=2) + "\n")
    else:
        say(to_prometheus(report["frames"]) if args.prometheus else status_of.text_of_all(report, now))
    return DONE


def noise_command(args):
    [folder] = frames.existing(args.out)
    plan = folder.read_plan()
    if not plan.target:
        raise Misuse(f"{args.out}: its plan has no --until-noise; for the noise of any samples, use latent-inspect noise")
    if tasks := state.unfinished(plan, state.read_state(folder, plan)):
        raise Failure(f"{args.out}: missing: {ranges.tasks_text(ranges.array_list(tasks))}; render what is missing with latent-farm resume {shown(args.out)}")
    found = noise.measure(folder, plan)
    args.spp = None if noise.is_over(folder, plan) else noise.next_spp(plan, found)
    say(f"noise: {status_of.noise_text(status_of.noise_of(folder, plan, found.samples), plan.spp)}\n")
    return resume_command(args)


def join_command(args):
    strips.join([pathlib.Path(path) for path in args.strip], pathlib.Path(args.output), args.force)
    return DONE


def film_command(args):
    output = pathlib.Path(args.output or Folder(args.folder).film)
    if output.exists() and not args.force:
        raise Failure(f"{output}: exists; choose another name, or use --force")
    film.make([folder.print for folder in frames.existing(args.folder)], args.fps, output)
    return DONE


RUN = {"plan": plan_command, "submit": submit_command, "resume": resume_command, "status": status_command, "noise": noise_command,
       "join": join_command, "film": film_command}
