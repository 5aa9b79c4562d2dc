"""From a surface to a plot of run time against error: which tolerance for linear regions pays?

    PYTHONPATH=build/python /usr/bin/python3 examples/python/03_time_against_error.py [SURFACE [PLOT.png]]
    tolerance   2%:  96% linear, error 1.93 %, 19.12 times as fast
    (and a row for each of the other tolerances; the times depend on the machine)
"""

import pathlib
import sys
import time

import lobe
import matplotlib.pyplot as plt
import numpy as np

surface = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2] / "data" / "liver.obj"
mesh = lobe.mesh(surface, edge=0.012)
along = np.argsort(mesh.points[:, 0])
held, pulled, move = along[:40], along[-12:], 0.1 * np.ptp(mesh.points[:, 0])
document = {"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
            "boundary": [{"fix": True, "where": {"vertices": held}}], "time": {"damping": 20}}
reference = lobe.Scene(document, mesh)


def run(scene):  # milliseconds per simulated second, and the displacements
    world = lobe.World(scene)
    hand = world.grasp(pulled)
    world.advance(1 / 60)
    start, begun = hand.position, time.perf_counter()
    for frame in range(60):
        hand.move_to(start + [0, 0, move * min(1, (frame + 1) / 30)])
        world.advance(1 / 60)
    return 1e3 * (time.perf_counter() - begun), world.snapshot().u


full, exact = run(reference)
points = [(0.0, full)]
gesture = {"name": "pull", "vertices": pulled, "displacement": [0, 0, move]}
for tolerance in (0.01, 0.02, 0.05, 0.1):
    proposal = lobe.propose_regions(reference, tolerance, gestures=[gesture])
    milliseconds, u = run(lobe.Scene(document, mesh, regions=proposal.regions))
    points.append((100 * lobe.compare(mesh, u, exact).l2, milliseconds))
    print(f"tolerance {tolerance:4.0%}: {proposal.linear_share:4.0%} linear, error {points[-1][0]:.2f} %, "
          f"{full / milliseconds:.2f} times as fast")
plt.plot(*np.array(points).T, "o")
plt.xlabel("error of the displacement [%]")
plt.ylabel("run time [ms per second of simulation]")
plt.savefig(sys.argv[2] if len(sys.argv) > 2 else "time_against_error.png", dpi=120)
