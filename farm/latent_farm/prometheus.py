"""The status of a render in the text format of Prometheus, https://prometheus.io/docs/instrumenting/exposition_formats/."""
from latent_farm.names import shown

OF_A_FRAME = {
    "samples": ("samples of the plan", lambda frame: frame["samples"]),
    "samples_committed": ("samples that are on disk", lambda frame: frame["committed"]),
    "samples_per_second": ("speed of all machines that work now", lambda frame: frame["samples_per_second"]),
    "seconds_left": ("time that the missing samples take, if anything works", lambda frame: frame["seconds_left"]),
    "tasks": ("tasks of the plan", lambda frame: frame["tasks"]),
    "tasks_finished": ("tasks whose part is complete", lambda frame: frame["tasks_finished"]),
    "tasks_working": ("tasks that committed samples recently", lambda frame: frame["tasks_working"]),
    "parts_stalled": ("unfinished parts without a recent commit", lambda frame: len(frame["stalled"])),
    "steps_failed": ("tasks and later steps whose last attempt failed", lambda frame: len(frame["failed"])),
    "steps_left": ("steps that are still to be run; 0 when all is done", lambda frame: len(frame["steps_left"])),
    "bytes": ("size of the parts and the merged file", lambda frame: frame["bytes"]),
    "bytes_when_finished": ("the same when all is done", lambda frame: frame["bytes_when_finished"]),
    "free_bytes": ("free space on the disk of the folder", lambda frame: frame["free_bytes"]),
}
OF_A_MACHINE = {
    "machine_samples_per_second": ("speed of a machine; 0 if it does not work now", lambda machine: machine["samples_per_second"]),
    "machine_last_commit_timestamp_seconds": ("time of the last commit of a machine", lambda machine: machine["last_commit"]),
}


def labels(**values):
    def quoted(text):
        return shown(text).replace("\\", r"\\").replace('"', r"\"")
    return "{" + ",".join(f'{name}="{quoted(value)}"' for name, value in values.items()) + "}"


def to_prometheus(frames):
    lines = []

    def add(name, about, rows):
        lines.extend([f"# HELP latent_farm_{name} {about}", f"# TYPE latent_farm_{name} gauge"])
        lines.extend(f"latent_farm_{name}{labels} {value}" for labels, value in rows if value is not None)
    for name, (about, value) in OF_A_FRAME.items():
        add(name, about, [(labels(folder=frame["folder"]), value(frame)) for frame in frames])
    for name, (about, value) in OF_A_MACHINE.items():
        add(name, about, [(labels(folder=frame["folder"], machine=host), value(machine))
                          for frame in frames for host, machine in sorted(frame["machines"].items())])
    return "\n".join(lines) + "\n"
