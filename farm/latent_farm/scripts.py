"""The scripts in the folder of a plan: one command for each step, and job scripts of Slurm around them."""
import math
import shlex

from latent_farm import tools
from latent_farm.plan import size_of, strip_name

TASK = """#!/bin/sh
# Written by latent-farm. Usage: task K    renders samples K * {length} up to the next task's into parts/.
# Exit status: 0 done; 75 interrupted, everything finished is saved: run it again to resume; others: latent-render --help.
k=$1
case $k in '' | *[!0-9]*) echo "usage: $0 K    (K: 0 to {last})" >&2; exit 2 ;; esac
first=$((k * {length})) end=$(((k + 1) * {length}))
[ "$first" -lt {samples} ] || {{ echo "$0: task $k: the last one is {last}" >&2; exit 2; }}
[ "$end" -le {samples} ] || end={samples}
case $0 in */*) folder=${{0%/*}} ;; *) folder=. ;; esac
scene={scene}  # LATENT_SCENE names it where it has another path
{program}
exec "$program" "${{LATENT_SCENE:-$scene}}" {options} \\
    --samples "$first:$end" --threads "${{SLURM_CPUS_PER_TASK:-{cpus}}}" --checkpoint {checkpoint:g} \\
    -o "$folder/parts/$(printf 'part-%05d' "$k").latent"
"""

MERGE = """#!/bin/sh
# Written by latent-farm. Joins parts/ into samples.latent. Fails, and names what is missing, unless all {samples} samples are there.
cd "$(dirname "$0")" || exit 1
set --
[ -z "$(ls parts)" ] || set -- parts
[ ! -e samples.latent ] || set -- "$@" samples.latent
{program}
"$program" "$@" --job {job} --require 0:{samples} --skip-duplicates{compact} --force -o samples.latent
status=$?
[ $status -ne 3 ] || status=0  # what was left out is listed above; nothing that was asked for is missing
exit $status
"""

DEVELOP = """#!/bin/sh
# Written by latent-farm. Develops samples.latent into picture.exr.
cd "$(dirname "$0")" || exit 1
{program}
exec "$program" samples.latent --samples 0:{samples} {options} --force -o picture.exr
"""

STRIP = """#!/bin/sh
# Written by latent-farm. Usage: develop K    develops rows K * {rows} up to the next strip's of samples.latent into strips/.
k=$1
case $k in '' | *[!0-9]*) echo "usage: $0 K    (K: 0 to {last})" >&2; exit 2 ;; esac
[ "$k" -le {last} ] || {{ echo "$0: strip $k: the last one is {last}" >&2; exit 2; }}
cd "$(dirname "$0")" && mkdir -p strips || exit 1
first=$((k * {rows})) end=$(((k + 1) * {rows}))
[ "$end" -le {height} ] || end={height}
{program}
exec "$program" samples.latent --samples 0:{samples} {options} --crop "0,$first,{width},$end" --force \\
    -o "$(printf 'strips/strip-%05d.exr' "$k")"
"""

JOIN = """#!/bin/sh
# Written by latent-farm. Joins strips/ into picture.exr.
cd "$(dirname "$0")" || exit 1
{program}
"$program" join {strips} --force -o picture.exr && rm -r strips
"""

# The renderer is a child of the shell, so that the shell can requeue the task when its time is up. docs/farm.md, "Slurm".
RENDER_JOB = """#!/bin/bash
# Written by latent-farm. Array index K of `sbatch --array=... render.sbatch OFFSET` is task OFFSET + K.
#SBATCH --job-name={name}-render
#SBATCH --nodes=1 --ntasks=1{cpus} --mem={memory}M --time={minutes}
#SBATCH --requeue --open-mode=append --signal=B:USR1@{notice}
#SBATCH --output="{logs}/render-%A_%a.log"
k=$((${{1:-0}} + SLURM_ARRAY_TASK_ID))
echo "task $k on ${{SLURMD_NODENAME:-$(hostname)}}, attempt $((${{SLURM_RESTART_COUNT:-0}} + 1))"
{task} "$k" &
child=$! again= status=0 signalled=1
trap 'signalled=1; kill -TERM $child 2>/dev/null' TERM           # cancelled, preempted or requeued: Slurm decides what follows
trap 'signalled=1 again=1; kill -TERM $child 2>/dev/null' USR1   # the time limit is near
while [ $signalled = 1 ]; do
    signalled=0
    wait $child
    result=$?
    [ $result = 127 ] || status=$result
done
if [ $status = 75 ] && [ -n "$again" ]; then
    # Not $SLURM_JOB_ID: for one task of an array, that is the number of the whole array.
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && sleep 300  # Slurm ends this script
fi
exit $status
"""

STEP_JOB = """#!/bin/bash
# Written by latent-farm.
#SBATCH --job-name={name}-{step}
#SBATCH --nodes=1 --ntasks=1{cpus} --mem={memory}M
#SBATCH --requeue --open-mode=append
#SBATCH --output="{logs}/{step}-%j.log"
echo "{step} on ${{SLURMD_NODENAME:-$(hostname)}}"
exec {script}
"""


def find_program(name):
    """Shell lines that set $program: the tool where it is here, or on the PATH of the machine that runs the script."""
    here = shlex.quote(tools.path_of(name))
    return f"program={here}\n[ -x \"$program\" ] || program={name}"


def minutes_of(plan):
    """A time limit with room for a machine that is slower than the one that was measured; a task that meets it goes on later."""
    return max(15, math.ceil(2 * plan.task_seconds / 60) + 10)


def write_scripts(folder, plan, name, minutes=None):
    minutes = minutes or minutes_of(plan)
    notice = min(180, 15 * minutes)  # seconds before the limit
    path, logs = folder.path, str(folder.logs).replace("%", "%%")
    options = shlex.join(plan.render_options)
    folder.write(path / "task", TASK.format(
        length=plan.task_samples, samples=plan.samples, last=plan.tasks - 1, program=find_program("latent-render"),
        scene=shlex.quote(plan.scene), options=options, cpus=plan.cpus, checkpoint=plan.checkpoint), 0o755)
    folder.write(path / "merge", MERGE.format(samples=plan.samples, job=plan.job, compact=" --compact" if plan.compact else "",
                                               program=find_program("latent-merge")), 0o755)
    develop = {"samples": plan.samples, "program": find_program("latent-develop"), "options": shlex.join(plan.develop)}
    steps = {"merge": "", "develop": ""}  # and their arguments
    if plan.strips == 1:
        folder.write(path / "develop", DEVELOP.format(**develop), 0o755)
    else:
        width, height = size_of(plan.develop)
        strips = plan.strip_tasks
        folder.write(path / "develop", STRIP.format(**develop, rows=plan.strip_rows, last=strips[-1], width=width, height=height), 0o755)
        folder.write(path / "join", JOIN.format(program=find_program("latent-farm"),
                                                strips=" ".join(f"strips/{strip_name(task)}" for task in strips)), 0o755)
        steps = {"merge": "", "develop": " $((${1:-0} + SLURM_ARRAY_TASK_ID))", "join": ""}
    cpus = f" --cpus-per-task={plan.cpus}" if plan.cpus else ""
    folder.write(path / "render.sbatch", RENDER_JOB.format(
        name=name, cpus=cpus, memory=plan.memory >> 20, minutes=minutes, notice=notice, logs=logs,
        task=shlex.quote(str(path / "task"))))
    for step, arguments in steps.items():
        folder.write(path / f"{step}.sbatch", STEP_JOB.format(
            name=name, step=step, cpus=cpus, memory=max(2 << 10, plan.memory >> 20), logs=logs,
            script=shlex.quote(str(path / step)) + arguments))
