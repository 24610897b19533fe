"""Counts the instructions of steps and compares them with those on record: python check_instructions.py [--renew]

Times on shared machines change by more than what a careless line costs; the number of instructions does not change at all. Each
case runs under `valgrind --tool=callgrind` for two numbers of steps, and the difference, per particle and step, is what counts:
what comes before the steps is not in it. `--renew` puts the new numbers on record.

Loops over particles must lie in what is compiled for vectors, `run_avx2` or `run_avx512`: a closure or a call that is not inlined there is
compiled for any processor, and takes several times as long, which no number on record would show of code that is new. So the check also
fails when too many instructions lie elsewhere.

Numbers on record are of one compiler and one set of vector instructions (the best that valgrind knows of the processor's).
With another compiler the margin is wider. With another set there is nothing to compare.
"""

import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORD = Path(__file__).with_name("instructions.json")
# Few and more steps of a case, or frames where the step is adaptive.
CASES = {
    "linear-100": (5, 25),
    "linear-10": (200, 1200),
    "measured-100": (5, 25),
    "friction-100": (2, 8),
    "linear-adaptive-60": (1, 2),
    "tangent-adaptive-32": (1, 2),
}
MARGIN = 0.03  # [1]
MARGIN_OF_ANOTHER_COMPILER = 0.25  # [1]
MOST_OUTSIDE = 0.15  # [1] of the instructions in no function that is compiled for vectors; a grid of 100 particles has 0.1
# What is compiled for vectors, by us or by the C library, whose repeated moves valgrind counts byte by byte.
INSIDE = re.compile(r"run_avx|^__mem")


def main():
    program = build()
    compiler = run(["rustc", "--version"]).stdout.strip()
    counts, sets, outside = {}, set(), []
    for name, steps in CASES.items():
        (few, few_steps, instructions), (more, more_steps, _) = (count(program, name, number) for number in steps)
        more.subtract(few)
        counts[name] = round(more.total() / (more_steps - few_steps), 2)
        sets.add(instructions)
        elsewhere = Counter({function: number for function, number in more.items() if not INSIDE.search(function)})
        share = elsewhere.total() / more.total()
        print(f"{name}: {share:.1%} of the instructions are in no loop that is compiled for vectors")
        if MOST_OUTSIDE < share:
            most = "".join(f"\n  {number / more.total():6.1%} {function}" for function, number in elsewhere.most_common(5))
            outside.append(f"{name}: more than {MOST_OUTSIDE:.0%} lie outside of vector loops; most of them in{most}")
    if outside:
        sys.exit("\n".join(outside))
    (instructions,) = sets
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    if "--renew" in sys.argv:
        record = record if record.get("compiler") == compiler else {"compiler": compiler, "instructions": {}}
        record["instructions"][instructions] = counts
        RECORD.write_text(json.dumps(record, indent=2) + "\n")
        print(f"{instructions}, {compiler}: {counts}")
        return
    if instructions not in record["instructions"]:
        print(f"notice: nothing on record for {instructions}: {counts}")
        return
    margin = MARGIN
    if record["compiler"] != compiler:
        margin = MARGIN_OF_ANOTHER_COMPILER
        print(f"notice: the record is of {record['compiler']}, this is {compiler}: {margin:.0%} more are allowed")
    faults = []
    for name, number in counts.items():
        expected = record["instructions"][instructions][name]
        change = number / expected - 1.0
        print(f"{name}, {instructions}: {number} instructions per particle and step, {change:+.1%} of {expected}")
        if margin < change:
            faults.append(f"{name}: {change:.1%} more instructions; more than {margin:.0%} need a reason and `--renew`")
        elif change < -MARGIN:
            print("notice: that is less; `--renew` keeps it so")
    print("\n".join(faults), end="\n" if faults else "")
    sys.exit(1 if faults else 0)


def build():
    """The benchmark's program."""
    command = ["cargo", "bench", "--locked", "--quiet", "-p", "muslin", "--bench", "step", "--no-run", "--message-format=json"]
    messages = [json.loads(line) for line in run(command).stdout.splitlines()]
    (program,) = [message["executable"] for message in messages if message.get("executable")]
    return program


def count(program, name, steps):
    """Instructions of each function in the whole run, how many steps of a particle it took, and with which set of instructions."""
    with tempfile.NamedTemporaryFile() as profile:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile.name}", program, "--steps", name, str(steps)]
        done = run(command)
        counts = by_function(Path(profile.name).read_text())
    instructions, particle_steps = done.stdout.split()
    (collected,) = re.findall(r"Collected : (\d+)", done.stderr)
    if counts.total() != int(collected):
        sys.exit(f"{name}: the functions have {counts.total()} instructions together, the run {collected}")
    return counts, int(particle_steps), instructions


def by_function(profile):
    """Instructions of each function itself in what callgrind wrote, where a number stands for a name that came before."""
    names, counts, function, is_call = {}, Counter(), "", False
    for line in profile.splitlines():
        if named := re.match(r"c?fn=(\(\d+\))(?: (.*))?", line):
            number, name = named.groups()
            names.setdefault(number, name)
            if line.startswith("fn="):
                function = names[number]
        elif line.startswith("calls="):
            is_call = True  # The next line has what is spent in the function that is called.
        elif re.match(r"[+\-*\d]", line):
            if not is_call:
                counts[function] += int(line.split()[-1])
            is_call = False
    return counts


def run(command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return done


if __name__ == "__main__":
    main()
