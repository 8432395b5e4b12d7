"""What the programs of this folder share."""

import json
import resource
import subprocess
import sys

from scipy.spatial import cKDTree


def neighbours(fluid, others, radius):
    """Mean number of particles nearer to a fluid particle than `radius`, itself not counted. `others`: walls, may be empty."""
    tree = cKDTree(fluid)
    count = tree.query_ball_point(fluid, radius, return_length=True).sum() - len(fluid)
    if len(others):
        count += cKDTree(others).query_ball_point(fluid, radius, return_length=True).sum()
    return float(count) / len(fluid)


def cpu_of(command):
    """CPU time (s) of a command from its start to its end, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode} of {' '.join(command)}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def report(**result):
    """Prints a result, a line of JSON: the last one that the programs print."""
    result["updates_per_cpu_s"] = result["fluid"] * result["steps"] / result["cpu_s"]
    print(json.dumps(result), flush=True)
