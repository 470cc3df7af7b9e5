"""What is to be done in the folder of a plan: the plan made, extended or as it was; what is missing; the commands that do it."""
from latent_farm import engines, planning, ranges, scripts, slurm, state
from latent_farm.errors import Misuse


class Work:
    """`like`: a plan of another frame, whose rate stands for this one's; `share`: of the machines."""

    def __init__(self, folder, args, like=None, share=1):
        self.folder = folder
        self.plan, measured = prepare(folder, args, like, share)
        self.found = state.read_state(folder, self.plan)
        self.missing = state.unfinished(self.plan, self.found)
        if self.missing and not measured:
            planning.check_scene(folder, self.plan)
        self.stages = state.stages_left(folder, self.plan, self.found, self.missing)
        self.lines = self._lines() if self.stages else []

    def _lines(self):
        if self.plan.engine == "slurm":
            return slurm.Chain(self.folder, self.plan).lines(self.stages)
        if self.plan.engine == "parallel":
            return [engines.parallel_line(self.folder, self.stages, self.plan.hosts)]
        return [engines.shell_line(self.folder, self.stages)]

    def report(self):
        """For --json."""
        plan, found = self.plan, self.found
        left = sum(ranges.size(ranges.missing(plan.range_of(task), found.held_by(task))) for task in self.missing)
        whole = plan.bytes * (1 if plan.until == "render" else 2)
        return {"folder": str(self.folder.path), "job": plan.job, "samples": plan.samples, "tasks": plan.tasks,
                "task_samples": plan.task_samples, "task_seconds": plan.task_seconds, "run_samples": plan.run_samples,
                "machines": plan.machines, "samples_per_second": plan.rate, "engine": plan.engine,
                "missing_tasks": ranges.array_list(self.missing),
                "missing_samples": left, "seconds": left / plan.rate / min(plan.machines, max(1, len(self.missing))),
                "bytes": whole, "bytes_needed": whole - found.disk, "free_bytes": found.free, "fits": whole - found.disk <= found.free,
                "until": plan.until, "steps_left_out": plan.steps_left_out,
                "steps": [stage.name for stage in self.stages], "commands": self.lines}


def prepare(folder, args, like, share):
    """The plan, in the folder, and whether the scene has been measured for it just now."""
    def shared(machines):
        return max(1, round(machines * share))

    if folder.has_plan():
        plan = folder.read_plan()
        folder.make()
        measured = bool(args.spp) and args.spp > plan.spp
        planning.extend(folder, plan, args, args.machines and shared(args.machines))
    elif args.scene and args.spp:
        nodes = slurm.nodes() if args.engine == "slurm" else []
        cpus = min((cpus for _, cpus in nodes), default=0) if args.cpus is None else args.cpus
        measured, machines = True, shared(args.machines or count_machines(args, cpus, nodes))
        with folder.made():
            plan = planning.make_plan(folder, args, cpus, machines, like)
    else:
        raise Misuse(f"{folder.path}: holds no plan yet; name a scene and --spp")
    folder.write_plan(plan)
    scripts.write_scripts(folder, plan)
    return plan, measured


def count_machines(args, cpus, nodes):
    if args.engine == "slurm":
        return max(1, sum(count * (each // max(1, cpus)) for count, each in nodes))
    return len(engines.hosts_in(args.hosts)) if args.hosts else 1
