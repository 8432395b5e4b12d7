"""Runs the programs one after the other, in several rounds, and says how many particles they update in a second of CPU time.

Started by `run`, which sets up what is needed; `run --help` says with what.
"""

import argparse
import csv
import json
import os
import signal
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "..", "..", "scenes")
OURS, REBUILT, OURS_3D = "storegga, 2D tank", "storegga, 2D tank, skin = 0", "storegga, 3D tank"
PYSPH, SPLISH, SALVA = "PySPH, 2D tank", "pysplishsplash, 2D dam break", "salva3d, 3D tank"
# Without these there is no ratio; the others may fail.
NEEDED = {OURS, REBUILT, PYSPH}

DIFFERENCES = """\
What differs between the tanks in the plane: ours has two phases, one of them Herschel-Bulkley, viscosity with no slip, rate of
strain with a corrected gradient, diffusion of density and a free-surface treatment, and keeps its lists of neighbours until a
particle has moved (skin = 0: for one step); PySPH's has one phase, artificial viscosity and none of these, and searches in every
sweep. README.md beside this program has more, and why the other rows are no ratios."""


def commands(options):
    """The command for each program, in the order of a round."""
    size, folder = f"{options.spacing:g}", options.folder
    warm_up, steps = str(options.warm_up), str(options.steps)
    # A tenth of the steps in three dimensions: there a step takes about ten times as long.
    few, some = str(max(options.warm_up // 10, 2)), str(max(options.steps // 10, 5))
    # Four times as coarse: about as many particles as in the plane.
    coarse = f"{4.0 * options.spacing:g}"

    def python(script, *arguments):
        return [sys.executable, os.path.join(HERE, script), *arguments]

    def ours(scene, spacing, warm_up, steps, *overrides):
        log = os.path.join(folder, f"{scene}.mcap")
        path = os.path.join(SCENES, f"{scene}.ron")
        return python("storegga_tank.py", options.storegga, path, spacing, warm_up, steps, log, *overrides)

    # The scene's floor is deeper than fluid can feel: four layers here, as in PySPH's tank.
    deep = 4.0 * options.spacing
    floor = f"--set=structures.floor.shape=Box(min:({-deep:g},{-deep:g}),max:({0.4 + deep:g},0.0))"
    all_commands = {
        OURS: ours("two_phase_tank", size, warm_up, steps, floor),
        REBUILT: ours("two_phase_tank", size, warm_up, steps, floor, "--set=neighbours.skin=0"),
        PYSPH: python("pysph_tank.py", size, warm_up, steps, f"--directory={folder}/pysph"),
    }
    if options.others:
        all_commands[SPLISH] = python("pysplishsplash_dam.py", size, warm_up, steps, f"{folder}/pysplishsplash")
        all_commands[OURS_3D] = ours("tank_3d", coarse, few, some)
        if options.salva:
            all_commands[SALVA] = python("salva_tank.py", options.salva, coarse, few, some)
    return all_commands


def measure(command, folder):
    """The result of a program, or why there is none."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
    if done.returncode < 0:
        return None, f"ended by {signal.Signals(-done.returncode).name}"
    if done.returncode > 0:
        lines = (done.stderr or done.stdout).strip().splitlines()
        return None, lines[-1] if lines else f"exit code {done.returncode}"
    return json.loads(done.stdout.strip().splitlines()[-1]), None


def spread(numbers, form):
    """Least, median and greatest."""
    return " / ".join(format(number, form) for number in (min(numbers), statistics.median(numbers), max(numbers)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--storegga", required=True)
    parser.add_argument("--salva", default="")
    parser.add_argument("--others", action="store_true")
    parser.add_argument("--rounds", type=int, required=True)
    parser.add_argument("--spacing", type=float, required=True)
    parser.add_argument("--warm-up", type=int, required=True)
    parser.add_argument("--steps", type=int, required=True)
    parser.add_argument("--folder", required=True)
    options = parser.parse_args()

    programs = commands(options)
    results = {name: [] for name in programs}
    for turn in range(options.rounds):
        # Every other round backwards: what drifts, such as the clock of a warm processor, meets all alike.
        for name in list(programs) if turn % 2 == 0 else reversed(list(programs)):
            result, reason = measure(programs[name], options.folder)
            if result is None and name in NEEDED:
                sys.exit(f"benches/peers: {name}: {reason}")
            if result is None:
                print(f"benches/peers: left out: {name}: {reason}", file=sys.stderr)
                del programs[name], results[name]
                continue
            results[name].append({"round": turn + 1, "program": name, **result})
            print(f"round {turn + 1}  {name:30}{result['updates_per_cpu_s']:12.0f} updates/CPU s", file=sys.stderr, flush=True)

    path = os.path.join(options.folder, "results.csv")
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, results[OURS][0].keys())
        table.writeheader()
        table.writerows(sorted((row for rows in results.values() for row in rows), key=lambda row: row["round"]))

    print("\nThousand updates of fluid particles in a CPU second, min / median / max; million pairs: median times neighbours")
    print(f"{'':30}{'fluid':>8}{'solid':>8}{'neighbours':>12}{'':>6}{'pairs':>8}  updates")
    for name, rows in results.items():
        row = rows[-1]
        rates = [row["updates_per_cpu_s"] / 1000.0 for row in rows]
        pairs = statistics.median(rates) * row["neighbours"] / 1000.0
        numbers = f"{row['fluid']:8}{row['solid']:8}{row['neighbours']:12.1f}{row['precision']:>6}{pairs:8.1f}"
        print(f"{name:30}{numbers}  {spread(rates, '.0f')}")
    print(f"\nRatio to PySPH within a round, of {options.rounds} rounds: min / median / max")
    for name in (OURS, REBUILT):
        ratios = [a["updates_per_cpu_s"] / b["updates_per_cpu_s"] for a, b in zip(results[name], results[PYSPH])]
        print(f"{name:30}{spread(ratios, '.2f')}")
    print(f"\n{DIFFERENCES}\n\nwritten: {path}")


if __name__ == "__main__":
    main()
