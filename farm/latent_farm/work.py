"""What is to be done: in the folder of a plan, made, extended or as it was; and for all frames together."""
from latent_farm import engines, frames, noise, planning, ranges, scripts, slurm, state
from latent_farm.errors import Failure, Misuse, STOPPED
from latent_farm.folder import Folder


class Work:
    """One frame. `like`: a plan of another one, whose rate stands for this one's; `share`: of the machines."""

    def __init__(self, folder, args, like=None, share=1):
        self.folder = folder
        self.plan, measured = prepare(folder, args, like, share)
        self.found = state.read_state(folder, self.plan)
        self.missing = state.unfinished(self.plan, self.found)
        if self.missing and not measured:
            planning.check_scene(folder, self.plan)
        self.stages = until_noise(state.stages_left(folder, self.plan, self.found, self.missing))

    def report(self):
        """For --json."""
        plan, found = self.plan, self.found
        left = sum(ranges.size(ranges.missing(plan.range_of(task), found.held_by(task))) for task in self.missing)
        whole = plan.bytes * (1 if plan.until == "render" else 2)
        at_a_time = 1 if plan.engine == "shell" else min(plan.machines, max(1, len(self.missing)))
        return {"folder": str(self.folder.path), "job": plan.job, "samples": plan.samples, "tasks": plan.tasks,
                "task_samples": plan.task_samples, "task_seconds": plan.task_seconds, "run_samples": plan.run_samples,
                "machines": plan.machines, "samples_per_second": plan.rate, "missing_tasks": ranges.array_list(self.missing),
                "missing_samples": left, "at_a_time": at_a_time, "seconds": left / plan.rate / at_a_time,
                "bytes": whole, "bytes_needed": max(0, whole - found.disk),
                "until": plan.until, "steps_left_out": plan.steps_left_out, "steps": [stage.name for stage in self.stages]}


class Works:
    """A scene, or all frames of an animation, and what follows when they are finished."""

    def __init__(self, args):
        self.folder = Folder(args.out)
        found = frames.frames_of(args)
        if args.until_noise and len(found) > 1:
            raise Misuse("--until-noise: is for one scene; give the frames of an animation the same --spp")
        self.frames = []
        for folder, own in found:
            self.frames.append(Work(folder, own, self.frames[0].plan if self.frames else None, 1 / len(found)))
        self.plan = self.frames[0].plan  # for what concerns all of them
        grows = any(stage.name == "noise" for stage in self.frames[0].stages)
        self.last = [] if grows else state.last_stages(self.folder, self.plan, [(frame.folder, frame.stages) for frame in self.frames])
        if self.last:
            self.folder.make(parts=False)
            scripts.write_scripts(self.folder, self.plan, scripts.last_scripts_of(self.plan))

    def _chains(self):
        return [(frame.folder, frame.plan, frame.stages) for frame in self.frames]

    def lines(self):
        """[the commands of each frame, and of what follows]."""
        if self.plan.engine != "slurm":
            return [engines.lines_of(*chain) for chain in self._chains()] + [engines.lines_of(self.folder, self.plan, self.last)]
        lines, jobs = [], []
        for number, (folder, plan, stages) in enumerate(self._chains()):
            own, last = slurm.Chain(folder, plan).lines(stages, name="J" if len(self.frames) == 1 else f"J{number}_")
            lines.append(own)
            jobs += last
        return lines + [slurm.Chain(self.folder, self.plan).lines(self.last, jobs, "L")[0]]

    def run(self):
        """Everything, by parallel or in a loop. Returns an exit status."""
        status = engines.Foreground().run([*self._chains(), (self.folder, self.plan, self.last)])
        if status == STOPPED:
            raise Failure(f"interrupted; what was finished is saved; go on with latent-farm resume {self.folder.path}", STOPPED)
        return status

    def submit(self):
        """The numbers of the jobs of Slurm: [those of each frame, and of what follows]."""
        numbers, jobs = [], []
        for folder, plan, stages in self._chains():
            own, last = slurm.Chain(folder, plan).submit(stages)
            numbers.append(own)
            jobs += last
        return numbers + [slurm.Chain(self.folder, self.plan).submit(self.last, jobs, known=numbers[0] if len(numbers) == 1 else ())[0]]

    def report(self):
        """For --json: of one scene the same as of many."""
        reports, lines = [frame.report() for frame in self.frames], self.lines()
        for report, own in zip(reports, lines):
            report["commands"] = own
        needed, free = sum(report["bytes_needed"] for report in reports), self.frames[0].found.free
        return {"folder": str(self.folder.path), "engine": self.plan.engine,
                **{key: sum(report[key] for report in reports) for key in ("samples", "missing_samples", "bytes")},
                "bytes_needed": needed, "free_bytes": free, "fits": needed <= free,
                "steps": [stage.name for stage in self.last], "commands": [line for own in lines for line in own], "jobs": [], "frames": reports}


def until_noise(stages):
    """Those up to the step that measures noise, which then runs what is left: nothing else knows how many samples there will be."""
    names = [stage.name for stage in stages]
    return stages[:names.index("noise") + 1] if "noise" in names else stages


def prepare(folder, args, like, share):
    """The plan, in the folder, and whether the scene has been measured for it just now."""
    def shared(machines):
        return max(1, round(machines * share))

    if folder.has_plan():
        plan = folder.read_plan()
        folder.make()
        measured = bool(args.spp) and args.spp > plan.spp
        planning.extend(folder, plan, args, args.machines and shared(args.machines))
    elif args.scene and (args.spp or args.until_noise):
        args.spp = args.spp or min(noise.FIRST_SPP, args.max_spp or noise.FIRST_SPP)
        nodes = slurm.nodes() if args.engine == "slurm" else []
        cpus = min((cpus for _, cpus in nodes), default=0) if args.cpus is None else args.cpus
        measured, machines = True, shared(args.machines or count_machines(args, cpus, nodes))
        with folder.made():
            plan = planning.make_plan(folder, args, cpus, machines, like)
    else:
        raise Misuse(f"{folder.path}: holds no plan yet; name a scene and --spp, or --until-noise")
    folder.write_plan(plan)
    scripts.write_scripts(folder, plan, scripts.scripts_of(plan))
    return plan, measured


def count_machines(args, cpus, nodes):
    if args.engine == "slurm":
        return max(1, sum(count * (each // max(1, cpus)) for count, each in nodes))
    return len(engines.hosts_in(args.hosts)) if args.hosts else 1
