"""Runs salva's tank (salva/) twice, short and long: the difference of the CPU times is that of the steps between.

Usage: salva_tank.py PROGRAM SPACING WARM_UP STEPS
"""

import sys

import numpy as np

from common import cpu_of, neighbours, report

SUPPORT = 2.0  # radius of the kernel in spacings, as in salva's examples


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    program, spacing, warm_up, steps = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    short, _ = cpu_of([program, spacing, str(SUPPORT), str(warm_up)])
    long, text = cpu_of([program, spacing, str(SUPPORT), str(warm_up + steps)])
    rows = [line.split() for line in text.splitlines()]
    fluid, solid = (np.array([row[1:] for row in rows if row[0] == kind], dtype=float) for kind in ("fluid", "solid"))
    report(
        fluid=len(fluid),
        solid=len(solid),
        neighbours=neighbours(fluid, solid, SUPPORT * float(spacing)),
        precision="f32",
        steps=steps,
        cpu_s=long - short,
    )


if __name__ == "__main__":
    main()
