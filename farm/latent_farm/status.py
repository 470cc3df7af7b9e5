"""latent-farm status: what is done, what is missing, who works, and how long the rest takes."""
import statistics
import time

from latent_farm import logs, noise, ranges, state, units
from latent_farm.names import shown
from latent_farm.plan import Stage

LAST = ["film", "done"]  # steps that follow when all frames are finished
MOST_SHOWN = 8  # failures, in text


def noise_of(folder, plan, committed):
    """For --json: the target, and what is known about it."""
    if not plan.target:
        return None
    found = noise.last(folder, plan)
    known = {"samples": found.samples, "median": found.median, "spp_needed": found.needed(plan.target) * plan.spp / plan.samples,
             "expected_now": found.expected(max(committed, found.samples))} if found else {}
    return {"target": plan.until_noise, "relative": plan.target.relative, "width": plan.target.width, "max_spp": plan.max_spp or None,
            "over": noise.is_over(folder, plan), **known}


def machines_of(plan, files, unfinished, now, stalled_after):
    """{host: ...} of all machines that have left a mark, and the attempts that stand still."""
    machines, stalled = {}, []
    newest = {file.task: file for file in sorted(files, key=lambda file: file.changed)}
    for file in files:
        machine = machines.setdefault(file.host, {"samples": 0, "parts": 0, "last_commit": 0, "rates": [], "working": 0, "stalled": 0})
        machine["samples"] += ranges.size(ranges.union(file.held))
        machine["parts"] += not file.attempt and file.task not in unfinished
        machine["last_commit"] = max(machine["last_commit"], file.changed)
        if file.rate:
            machine["rates"].append(file.rate)
        if not file.attempt or file.over or file.task not in unfinished or file is not newest[file.task]:  # another has gone on with it
            continue
        if now - file.changed <= stalled_after:
            machine["working"] += 1
        else:
            machine["stalled"] += 1
            stalled.append(file.name)
    rates = [rate for machine in machines.values() for rate in machine["rates"]] or [plan.rate]
    for machine in machines.values():
        each = statistics.median(machine.pop("rates") or rates)
        machine["samples_per_second"] = each * machine["working"]
    return machines, stalled


def summary(folder, plan, found, now, stalled_after):
    """Everything that status has to say, for --json."""
    tasks = state.unfinished(plan, found)
    machines, stalled = machines_of(plan, found.files, set(tasks), now, stalled_after)
    lacking = ranges.missing((0, plan.samples), found.held())
    stages = state.stages_left(folder, plan, found, tasks)
    rate = sum(machine["samples_per_second"] for machine in machines.values())
    lacks = ranges.size(lacking)
    working = sum(machine["working"] for machine in machines.values())
    per_sample = found.disk / max(1, ranges.size(ranges.union(r for f in found.files for r in f.held)) + ranges.size(found.merged))
    held_twice = 1 if plan.until == "render" else 2
    committed = plan.samples - lacks
    return {
        "folder": str(folder.path), "scene": plan.scene, "job": plan.job, "spp": plan.spp,
        "samples": plan.samples, "committed": committed, "missing_samples": [list(r) for r in lacking],
        "tasks": plan.tasks, "tasks_finished": plan.tasks - len(tasks), "tasks_working": working,
        "missing_tasks": ranges.array_list(tasks), "stalled": stalled,
        "samples_per_second": rate, "seconds_left": 0 if not lacks else lacks / rate if rate else None,
        "machines": machines, "bytes": found.disk,
        "bytes_when_finished": round(held_twice * plan.samples * (per_sample or plan.bytes_per_sample)),
        "free_bytes": found.free, "spare": [file.name for file in found.spare], "spare_bytes": sum(file.bytes for file in found.spare), "left_out": [{"place": place, "reason": reason} for place, reason in found.left_out],
        "noise": noise_of(folder, plan, committed), "until": plan.until, "steps_left_out": plan.steps_left_out, "complete": not lacks, "merged": not ranges.missing((0, plan.samples), found.merged),
        "steps_left": [stage.name for stage in stages],
        "failed": [failed._asdict() for failed in logs.failures(folder, stages)],
    }


def noise_text(known, spp):
    """Of what noise_of found, where the plan has so many samples per pixel."""
    if "median" not in known:
        return f"not measured yet, of {known['target']}"
    text = f"{100 * known['expected_now']:.3g} %, of {known['target']}"
    if known["median"] <= known["relative"]:
        return text
    if known["over"]:
        return text + f"; --max-spp {known['max_spp']:g} is reached"
    return text + f"; that takes about {known['spp_needed']:.3g} samples per pixel, after {spp:g}"


def to_text(report, now):
    done = 100 * report["committed"] / report["samples"]
    lines = [f"{shown(report['scene'])}, {report['spp']:g} sample{'' if report['spp'] == 1 else 's'} per pixel, job {report['job']}",
             f"samples: {report['committed']} of {report['samples']} committed ({done:.1f} %)",
             f"tasks:   {report['tasks_finished']} of {report['tasks']} finished, {report['tasks_working']} being rendered"]
    if report["missing_samples"]:
        lines.append(f"missing: samples {ranges.text([tuple(r) for r in report['missing_samples']])}")
    if report["missing_tasks"]:
        lines.append(f"         {ranges.tasks_text(report['missing_tasks'])}")
    if report["samples_per_second"]:
        left = report["seconds_left"]
        lines.append(f"rate:    {units.format_count(report['samples_per_second'])} samples/s, {units.format_duration(left)} left")
    if report["noise"]:
        lines.append("noise:   " + noise_text(report["noise"], report["spp"]))
    lines.append(f"disk:    {units.format_size(report['bytes'])} used, {units.format_size(report['bytes_when_finished'])} "
                 f"when finished, {units.format_size(report['free_bytes'])} free")
    if report["spare"]:
        lines.append(f"spare:   {units.counted(len(report['spare']), 'attempt')} at finished tasks, {units.format_size(report['spare_bytes'])}; "
                     "delete them if you like")
    lines += failures_text(report["failed"])
    if report["steps_left"]:
        lines.append(f"left:    {', '.join(report['steps_left'])}")
    else:
        lines.append("all done" + units.left_out(report))
    if report["machines"]:
        lines += ["", f"{'machine':<20} {'finished':>8} {'samples':>10} {'samples/s':>10}  last commit"]
    for name, machine in sorted(report["machines"].items()):
        host = shown(name, 60)
        ago = units.format_duration(max(0, now - machine["last_commit"])) + " ago"
        rate = units.format_count(machine["samples_per_second"]) if machine["working"] else "-"
        lines.append(f"{host:<20} {machine['parts']:>8} {units.format_count(machine['samples']):>10} {rate:>10}  {ago}")
    lines += [f"stalled: {shown(name)}" for name in report["stalled"]]
    lines += [f"left out: {shown(item['place'])}: {shown(item['reason'])}" for item in report["left_out"]]
    return "\n".join(lines) + "\n"


def status(whole, folders, stalled_after):
    """Of one scene, or of the frames of an animation, in the folder `whole`; and the time at which it was so."""
    now = time.time()
    plans = [folder.read_plan() for folder in folders]
    reports = [summary(folder, plan, state.read_state(folder, plan), now, stalled_after) for folder, plan in zip(folders, plans)]
    last = state.last_stages(whole, plans[0], [(folder, report["steps_left"]) for folder, report in zip(folders, reports)])
    samples, committed, rate = (sum(report[key] for report in reports) for key in ("samples", "committed", "samples_per_second"))
    left = samples - committed
    failed = [item for report in reports for item in report["failed"]]
    failed += [item._asdict() for item in logs.failures(whole, [Stage(step) for step in LAST])]
    return {
        "folder": str(whole.path), "engine": plans[0].engine, "samples": samples, "committed": committed, "samples_per_second": rate,
        "seconds_left": 0 if not left else left / rate if rate else None, "complete": not left,
        "frames_done": sum(not report["steps_left"] for report in reports), "steps_left": [*dict.fromkeys(step for report in reports for step in report["steps_left"]), *(stage.name for stage in last)],
        "failed": failed, "frames": reports}, now


def text_of_all(report, now):
    texts = [to_text(frame, now) for frame in report["frames"]]
    if len(texts) > 1:
        done = 100 * report["committed"] / report["samples"]
        text = f"{report['frames_done']} of {len(texts)} frames are done; {report['committed']} of {report['samples']} samples committed ({done:.1f} %)"
        texts.append(text + (f", {units.format_duration(report['seconds_left'])} left" if report["seconds_left"] else "") + "\n")
    last = [step for step in report["steps_left"] if step in LAST]
    last = [f"then:    {', '.join(last)}"] * bool(last) + failures_text([item for item in report["failed"] if item["step"] in LAST])
    return "\n".join(texts) + "".join(line + "\n" for line in last)


def failures_text(failed):
    """What failed and why, in lines."""
    lines = []
    for item in failed[:MOST_SHOWN]:
        what = item["step"] if item["task"] is None else f"{item['step']} {item['task']}"
        lines += [f"failed:  {what} on {shown(item['host'], 60)}: {shown(item['reason'], 300)}", f"         log: {item['log']}"]
    return lines + [f"         and {len(failed) - MOST_SHOWN} more"] * (len(failed) > MOST_SHOWN)
