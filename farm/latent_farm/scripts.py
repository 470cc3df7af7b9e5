"""The scripts in the folder of a plan: one for each step, one that runs them and keeps their logs, and jobs of Slurm around it.
They are constant text. What varies is assigned at their top, quoted by `script`; the jobs of Slurm hold whole numbers only."""
import math
import shlex

from latent_farm import files, tools
from latent_farm.plan import size_of, strip_name

NUMBERED = """
case $k in '' | *[!0-9]* | 0?*) echo "usage: $0 K    (K: 0 to $last)" >&2; exit 2 ;; esac
[ "$k" -le "$last" ] || { echo "$0: $k: the last one is $last" >&2; exit 2; }
"""
CHDIR = """
unset CDPATH
cd "$(dirname -- "$0")" || exit 1
"""

TASK_USAGE = """task K    renders task K into parts/.
# Exit status: 0 done; 75 interrupted, everything finished is saved: run it again to resume; others: latent-render --help.
# LATENT_SCENE names the scene where it has another path."""
TASK = NUMBERED + """
first=$((k * length)) end=$(((k + 1) * length))
[ "$end" -le "$samples" ] || end=$samples
case $0 in */*) folder=${0%/*} ;; *) folder=. ;; esac
exec "$program" "${LATENT_SCENE:-$scene}" "$@" --samples "$first:$end" \\
    --threads "${SLURM_CPUS_PER_TASK:-$cpus}" --checkpoint "$checkpoint" -o "$folder/parts/$(printf 'part-%05d' "$k").latent"
"""

MERGE_USAGE = """merge    joins parts/ into samples.latent. Fails, and names what is missing, unless all samples are there."""
MERGE = CHDIR + """
[ -z "$(ls parts)" ] || set -- "$@" parts
[ ! -e samples.latent ] || set -- "$@" samples.latent
"$program" "$@" --job "$job" --require "0:$samples" --skip-duplicates --force -o samples.latent
status=$?
[ $status -ne 3 ] || status=0  # what was left out is listed above; nothing that was asked for is missing
[ $status -eq 0 ] || echo "merge: if a part is damaged, move it away; latent-farm resume then renders its samples again" >&2
exit $status
"""

NOISE_USAGE = """noise    measures the noise of the samples, and runs what is left: more tasks, or the later steps."""
NOISE = CHDIR + """
exec "$program" noise .
"""

DEVELOP_USAGE = """develop    develops samples.latent into picture.exr."""
DEVELOP = CHDIR + """
exec "$program" samples.latent --samples "0:$samples" "$@" --force -o picture.exr
"""

STRIP_USAGE = """develop K    develops strip K of samples.latent into strips/."""
STRIP = NUMBERED + CHDIR + """
mkdir -p strips || exit 1
first=$((k * rows)) end=$(((k + 1) * rows))
[ "$end" -le "$height" ] || end=$height
exec "$program" samples.latent --samples "0:$samples" "$@" --crop "0,$first,$width,$end" --force \\
    -o "$(printf 'strips/strip-%05d.exr' "$k")"
"""

JOIN_USAGE = """join    joins strips/ into picture.exr."""
JOIN = CHDIR + """
"$program" join "$@" --force -o picture.exr && rm -r strips
"""

PRINT_USAGE = """print    prints picture.exr as picture.png."""
PRINT = CHDIR + """
exec "$program" picture.exr "$@" --force -o picture.png
"""

FILM_USAGE = """film    makes film.mp4 of the prints of all frames."""
FILM = CHDIR + """
exec "$program" film . "$@" --force -o film.mp4
"""

DONE_USAGE = """done    runs the command that --on-done names, when all is done."""
DONE = CHDIR + """
folder=$PWD exec sh -c "$command"
"""

# The command is a child, so that the shell notes how it ended, and can requeue its job of Slurm. docs/farm.md, "Slurm".
RUN = """#!/bin/bash
# Written by latent-farm. Usage: run STEP [K]    runs STEP K, a script of this folder, and adds what it says to a file in logs/.
# Signals are passed on to the step. Its exit status is that of the step.
case $1/$2 in
    task/*[!0-9]* | develop/*[!0-9]* | task/) echo "usage: $0 STEP [K]" >&2; exit 2 ;;
    task/* | noise/ | merge/ | develop/* | join/ | print/ | film/ | done/) ;;
    *) echo "usage: $0 STEP [K]    (STEP: task, noise, merge, develop, join, print, film or done)" >&2; exit 2 ;;
esac
what=$1${2:+ $((10#$2))}
case $0 in */*) folder=${0%/*} ;; *) folder=. ;; esac
log=$folder/logs/$1${2:+-$(printf %05d $((10#$2)))}.log
if [ -L "$log" ] || { [ -e "$log" ] && [ ! -f "$log" ]; }; then
    echo "$0: $log: is not a regular file; remove it" >&2
    exit 1
fi
exec > >(trap '' INT TERM HUP USR1 USR2 && exec tee -a -- "$log" >&2) 2>&1
tee=$!
echo "$what on ${SLURMD_NODENAME:-$(hostname)}, $(date -u +%Y-%m-%dT%H:%M:%SZ)${SLURM_RESTART_COUNT:+, restart $SLURM_RESTART_COUNT}"
"$folder/$1" ${2:+$((10#$2))} &
child=$! again= status=0 signalled=1
trap 'signalled=1; kill -TERM $child 2>/dev/null' INT TERM HUP  # cancelled, preempted or requeued: Slurm decides what follows
trap 'signalled=1 again=1; kill -TERM $child 2>/dev/null' USR1 USR2  # the time limit is near
while [ $signalled = 1 ]; do
    signalled=0
    wait $child
    result=$?
    [ $result = 127 ] || status=$result
done
case $status in
    0) ;;
    75) echo "$what: interrupted; what it finished is saved" ;;
    137) echo "$what: failed with status 137: killed, perhaps because memory ran out" ;;
    *) echo "$what: failed with status $status" ;;
esac
if [ $status = 75 ] && [ -n "$again" ] && [ -n "${LATENT_REQUEUE-}" ]; then
    scontrol requeue "$LATENT_REQUEUE" && sleep 300  # Slurm ends this script
fi
exec >&- 2>&-
wait $tee
exit $status
"""

JOB = """#!/bin/bash
# Written by latent-farm, for sbatch --chdir=FOLDER{usage}
# Its output is that of run, which keeps it in logs/: --output would replace parts of the folder's name, such as %A.
#SBATCH --nodes=1 --ntasks=1 --mem={memory:d}M --requeue --output=/dev/null
{directives}exec ./run {step}
"""
ARRAY_USAGE = " --array=INDICES FILE OFFSET: index I is {step} OFFSET + I"
REQUEUE = "export LATENT_REQUEUE=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID  # SLURM_JOB_ID may be that of the whole array\n"
NUMBER = " $((${1:-0} + ${SLURM_ARRAY_TASK_ID:?is set by Slurm; without it, use ./run}))"


def script(usage, body, tool="latent-farm", options=(), **values):
    """A script whose body finds its argument in $k, `options` in $@, a tool in $program, and each of `values` under its name."""
    given = "\n".join(f"{name}={shlex.quote(str(value))}" for name, value in {**values, "program": tools.path_of(tool)}.items())
    return (f"#!/bin/sh\n# Written by latent-farm. Usage: {usage}\nk=$1\n{given}\n"
            f'[ -x "$program" ] || program={tool}  # on the PATH of another machine\n{shlex.join(["set", "--", *options])}{body}')


def minutes_of(plan):
    """A time limit with room for a machine that is slower than the one that was measured; a task that meets it goes on later."""
    return max(1, round(plan.time / 60)) if plan.time else max(15, math.ceil(2 * plan.task_seconds / 60) + 10)


def scripts_of(plan):
    """{name: text} of all steps."""
    scripts = {
        "run": RUN,
        "task": script(TASK_USAGE, TASK, "latent-render", plan.render_options, length=plan.task_samples, samples=plan.samples,
                       last=plan.tasks - 1, scene=plan.scene, cpus=plan.cpus, checkpoint=f"{plan.checkpoint:g}"),
        "merge": script(MERGE_USAGE, MERGE, "latent-merge", ["--compact"] if plan.compact else [], job=plan.job, samples=plan.samples)}
    if plan.target:
        scripts["noise"] = script(NOISE_USAGE, NOISE)
    if plan.until == "print":
        scripts["print"] = script(PRINT_USAGE, PRINT, "latent-convert", plan.print)
    if plan.strips == 1:
        return {**scripts, "develop": script(DEVELOP_USAGE, DEVELOP, "latent-develop", plan.develop, samples=plan.samples)}
    width, height = size_of(plan.develop)
    strips = plan.strip_tasks
    return {**scripts,
            "develop": script(STRIP_USAGE, STRIP, "latent-develop", plan.develop, samples=plan.samples, rows=plan.strip_rows,
                              last=strips[-1], width=width, height=height),
            "join": script(JOIN_USAGE, JOIN, "latent-farm", [f"strips/{strip_name(task)}" for task in strips])}


def job_of(plan, step):
    """The script of a job of Slurm, or of an array of jobs, that runs a step."""
    numbered = step == "task" or step == "develop" and plan.strips > 1
    directives = f"#SBATCH --cpus-per-task={plan.cpus:d}\n" if plan.cpus else ""
    if step == "task":
        minutes = minutes_of(plan)
        directives += f"#SBATCH --time={minutes:d} --signal=B:USR1@{min(180, 15 * minutes):d}\n{REQUEUE}"  # seconds before the limit
    memory = max(1 if step == "task" else 2 << 10, plan.memory >> 20)
    return JOB.format(usage=ARRAY_USAGE.format(step=step) if numbered else " FILE", memory=memory, step=step + (NUMBER if numbered else ""),
                      directives=directives)


def last_scripts_of(plan):
    """The same for what is done when all frames are finished."""
    return {"run": RUN, "film": script(FILM_USAGE, FILM, options=["--fps", f"{plan.fps:g}"]),
            "done": script(DONE_USAGE, DONE, command=plan.on_done)}


def write_scripts(folder, plan, scripts):
    for name, text in scripts.items():
        files.write(folder.path / name, text, 0o777)
    for step in scripts.keys() - {"run"}:
        files.write(folder.path / f"{step}.sbatch", job_of(plan, step))
