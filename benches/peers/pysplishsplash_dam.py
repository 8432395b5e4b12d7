"""A 2D dam break of pysplishsplash with its explicit weakly compressible solver.

Usage: pysplishsplash_dam.py SPACING WARM_UP STEPS FOLDER
"""

import ctypes
import json
import os
import sys
import time

try:
    # The wheel brings a part of OpenGL; unless the system's is loaded first, the two mix and the import crashes.
    ctypes.CDLL("libGL.so.1", ctypes.RTLD_GLOBAL)
except OSError:
    sys.exit("pysplishsplash_dam.py: the system has no libGL.so.1, which pysplishsplash needs")

import numpy as np
import pysplishsplash as splish

from common import neighbours, report


def scene(spacing, steps):
    """A block of 0.4 m × 0.4 m at the end of a tank three times as long."""
    step = spacing / 100.0  # s
    return {
        "Configuration": {
            "sim2D": True,
            "particleRadius": spacing / 2.0,
            "simulationMethod": 0,  # WCSPH
            "WCSPH": {"stiffness": 50000.0, "exponent": 7.0},
            "gravitation": [0.0, -9.81, 0.0],
            "cflMethod": 0,  # a constant step
            "timeStepSize": step,
            "boundaryHandlingMethod": 0,  # particles, Akinci et al. 2012
            # Half a step more, lest rounding take one away.
            "stopAt": (steps + 0.5) * step,
        },
        "Materials": [
            {"id": "Fluid", "density0": 1000.0, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 0.01}}
        ],
        "RigidBodies": [
            {
                "geometryFile": os.path.join(sys.prefix, "bin", "data", "models", "UnitBox.obj"),
                "translation": [0.6, 0.4, 0.0],
                "scale": [1.2, 0.8, 1.0],
                "isDynamic": False,
                "isWall": True,
            }
        ],
        # It fills a block with one particle less in each direction than fit.
        "FluidBlocks": [
            {
                "denseMode": 0,
                "start": [spacing, spacing, -1.0],
                "end": [0.4 + 2.0 * spacing, 0.4 + 2.0 * spacing, 1.0],
            }
        ],
    }


def positions(model, count):
    return np.array([model.getPosition(i) for i in range(count)])


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    spacing, warm_up, steps, folder = float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), os.path.abspath(sys.argv[4])
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "dam.json")
    with open(path, "w") as file:
        json.dump(scene(spacing, warm_up + steps), file)

    marks = []
    last = {}

    def after_step():
        marks.append(time.process_time())
        if len(marks) == warm_up + steps:
            # Here, for the end of the run takes the particles away.
            sim = splish.Simulation.getCurrent()
            fluid, wall = sim.getFluidModel(0), sim.getBoundaryModel(0)
            last["fluid"] = positions(fluid, fluid.numActiveParticles())
            last["solid"] = positions(wall, wall.numberOfParticles())
            last["radius"] = sim.getSupportRadius()

    base = splish.Exec.SimulatorBase()
    base.init(sceneFile=path, useGui=False, useCache=False, outputDir=folder, initialPause=False)
    base.setTimeStepCB(after_step)
    base.run()
    if not last:
        sys.exit(f"pysplishsplash_dam.py: the run ended after {len(marks)} steps of {warm_up + steps}")
    if len(last["solid"]) == 0:
        sys.exit("pysplishsplash_dam.py: there are no walls: is data/models/UnitBox.obj in the virtual environment's bin?")
    report(
        fluid=len(last["fluid"]),
        solid=len(last["solid"]),
        neighbours=neighbours(last["fluid"], last["solid"], last["radius"]),
        precision="f32" if last["fluid"].dtype == np.float32 else "f64",
        steps=steps,
        cpu_s=marks[warm_up + steps - 1] - marks[warm_up - 1],
    )


if __name__ == "__main__":
    main()
