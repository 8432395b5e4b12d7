"""PySPH's hydrostatic tank (pysph.examples.hydrostatic_tank, its first formulation) in the shape of Storegga's.

Usage: pysph_tank.py SPACING WARM_UP STEPS [PYSPH OPTION]...

A tank of 0.4 m × 0.4 m with walls of four layers, 0.48 m high; quintic spline, h = 1.2 spacings, double precision; walls after
Adami et al. 2012; one evaluation of forces a step.
"""

import sys
import time

import numpy as np
from pysph.base.kernels import QuinticSpline
from pysph.base.utils import get_particle_array_wcsph
from pysph.solver.application import Application
from pysph.solver.solver import Solver
from pysph.sph.equation import Equation, Group
from pysph.sph.integrator import PECIntegrator
from pysph.sph.integrator_step import WCSPHStep
from pysph.sph.wc.basic import TaitEOS
from pysph.sph.wc.transport_velocity import (
    ContinuityEquation,
    MomentumEquationArtificialViscosity,
    MomentumEquationPressureGradient,
    SolidWallPressureBC,
    VolumeFromMassDensity,
)

from common import neighbours, report

WIDTH, DEPTH, HEIGHT = 0.4, 0.4, 0.48  # m
LAYERS = 4
RATIO = 1.2  # h / spacing
DENSITY = 1000.0  # kg/m³
GRAVITY = -9.81  # m/s²
SPEED = np.sqrt(-GRAVITY * DEPTH)  # m/s
SOUND = 10.0 * SPEED  # m/s
DAMPING = 1.0  # s: gravity grows from nothing, as in the example


class Advection(Equation):
    """The velocity with which `WCSPHStep` moves particles.

    The example has XSPH for it, with a coefficient of zero: the same bits, by a sum over neighbours, in a sixth more time.
    """

    def post_loop(self, d_idx, d_ax, d_ay, d_az, d_u, d_v, d_w):
        d_ax[d_idx] = d_u[d_idx]
        d_ay[d_idx] = d_v[d_idx]
        d_az[d_idx] = d_w[d_idx]


class Tank(Application):
    def initialize(self):
        self.spacing, self.warm_up, self.steps = float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])

    def create_particles(self):
        dx = self.spacing
        columns, wall, fill = (round(length / dx) for length in (WIDTH, HEIGHT, DEPTH))
        i, j = np.meshgrid(np.arange(-LAYERS, columns + LAYERS), np.arange(-LAYERS, wall), indexing="xy")
        i, j = i.ravel(), j.ravel()
        inside = (i >= 0) & (i < columns) & (j >= 0)
        arrays = []
        for name, chosen in (("fluid", inside & (j < fill)), ("solid", ~inside)):
            x, y = (i[chosen] + 0.5) * dx, (j[chosen] + 0.5) * dx
            array = get_particle_array_wcsph(name=name, x=x, y=y, h=RATIO * dx, m=DENSITY * dx * dx, rho=DENSITY)
            array.add_property("V", data=1.0 / (dx * dx))
            arrays.append(array)
        self.fluid, self.solid = arrays
        self.fluid.rho0[:] = DENSITY
        self.solid.add_property("wij")
        for name in ("auhat", "avhat", "awhat"):
            self.fluid.add_property(name)
        return arrays

    def create_solver(self):
        h = RATIO * self.spacing
        return Solver(
            kernel=QuinticSpline(dim=2),
            dim=2,
            integrator=PECIntegrator(fluid=WCSPHStep()),
            dt=0.75 * 0.25 * h / (SOUND + SPEED),
            tf=1e3,
        )

    def create_equations(self):
        both = ["fluid", "solid"]
        return [
            Group([VolumeFromMassDensity(dest="fluid", sources=None)]),
            Group([TaitEOS(dest="fluid", sources=None, rho0=DENSITY, c0=SOUND, gamma=1.0)]),
            Group([
                SolidWallPressureBC(
                    dest="solid", sources=["fluid"], b=1.0, gy=GRAVITY, rho0=DENSITY, p0=SOUND * SOUND * DENSITY
                ),
            ]),
            Group([
                ContinuityEquation(dest="fluid", sources=both),
                MomentumEquationPressureGradient(dest="fluid", sources=both, pb=0.0, gy=GRAVITY, tdamp=DAMPING),
                MomentumEquationArtificialViscosity(dest="fluid", sources=both, alpha=0.24, c0=SOUND),
                Advection(dest="fluid", sources=None),
            ]),
        ]

    def post_step(self, solver):
        # Called at the end of each step, before `count` grows.
        done = solver.count + 1
        if done == self.warm_up:
            self.started = time.process_time()
        elif done == self.warm_up + self.steps:
            self.cpu_s = time.process_time() - self.started


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    tank = Tank()
    steps = tank.warm_up + tank.steps
    tank.run(["--disable-output", "--quiet", "--fixed-h", "--no-openmp", f"--max-steps={steps}", *sys.argv[4:]])
    fluid, solid = (np.stack([array.x, array.y], axis=1) for array in (tank.fluid, tank.solid))
    if not np.isfinite(fluid).all():
        sys.exit("pysph_tank.py: the run diverged")
    report(
        fluid=len(fluid),
        solid=len(solid),
        # With these options the radius of its search: 3h.
        neighbours=neighbours(fluid, solid, tank.solver.kernel.radius_scale * RATIO * tank.spacing),
        precision="f64",
        steps=tank.steps,
        cpu_s=tank.cpu_s,
    )


if __name__ == "__main__":
    main()
