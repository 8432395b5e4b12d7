"""Runs a tank of Storegga twice, short and long: the difference of the CPU times is that of the steps between, without start-up.

Usage: storegga_tank.py STOREGGA SCENE SPACING WARM_UP STEPS LOG [--set PATH=VALUE]...
"""

import json
import sys

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from common import cpu_of, neighbours, report

RATIO = 1.2  # h / spacing
# `foxglove.PackedElementField`: float 32 and float 64.
NUMBERS = {7: "<f4", 8: "<f8"}


def run(command, until):
    """Runs up to the time `until`; the summary of the run, with the CPU time of the process."""
    cpu, text = cpu_of([*command, "--until", f"{until:.9f}"])
    return json.loads(text) | {"cpu_s": cpu}


def positions(log, topic):
    """Positions in the last frame of a cloud of a log."""
    cloud = None
    with open(log, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, _, _, cloud in reader.iter_decoded_messages(topics=[topic]):
            pass
    if cloud is None:
        return np.empty((0, 3))
    rows, stride = len(cloud.data) // cloud.point_stride, cloud.point_stride
    columns = [
        np.ndarray(rows, NUMBERS[field.type], cloud.data, field.offset, stride)
        for field in cloud.fields
        if field.name in ("x", "y", "z")
    ]
    return np.stack(columns, axis=1).astype(float)


def main():
    if len(sys.argv) < 7:
        sys.exit(__doc__)
    storegga, scene, spacing, warm_up, steps, log = sys.argv[1:7]
    spacing, warm_up, steps = float(spacing), int(warm_up), int(steps)
    # Frames and rows at the start and the end only: both runs write the same, so the difference has nothing of it.
    overrides = [f"--set=spacing={spacing}", "--set=log.particles=1000", "--set=log.series=1000"]
    overrides.append(f"--set=smoothing_ratio={RATIO}")
    command = [storegga, "run", scene, "--threads", "1", "--json", "--out", log, *overrides, *sys.argv[7:]]

    # A step is a quarter of the time in which sound crosses h; in these tanks that is about a spacing / (80 m/s).
    short = run(command, warm_up * spacing / 80.0)
    step = short["time"] / short["steps"]
    long = run(command, short["time"] + steps * step)

    fluid = positions(log, "/particles")
    solid = np.concatenate([positions(log, "/walls"), positions(log, "/structures")])
    report(
        fluid=len(fluid),
        solid=len(solid),
        # The support of the quintic spline is 3h.
        neighbours=neighbours(fluid, solid, 3.0 * RATIO * spacing),
        precision="f64",
        steps=long["steps"] - short["steps"],
        cpu_s=long["cpu_s"] - short["cpu_s"],
    )


if __name__ == "__main__":
    main()
