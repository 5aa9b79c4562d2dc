"""Takes hold of the liver's left lobe, lifts it by 2 cm, and says what force that takes.

    PYTHONPATH=build/python /usr/bin/python3 examples/python/01_gesture.py
    lifted by 20 mm: 2.97 N, the body has moved by up to 20.2 mm

Its tetrahedra are edge-smoothed, as in every scene that names no element. With "element": "tetrahedron" in
the material they are plain, as in examples/05_instrument.cpp, and too stiff: 3.52 N.
"""

import pathlib

import lobe
import numpy as np

DATA = pathlib.Path(__file__).parents[2] / "data"
mesh = lobe.read_mesh(DATA / "meshes" / "liver_2k.vtu")
scene = lobe.Scene({
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "boundary": [{"fix": True, "where": {"box": {"min": [-1, 0.015, -1], "max": [-0.02, 1, 1]}}}],
    "time": {"damping": 20},
}, mesh)
world = lobe.World(scene)

hand = world.grasp(near=(0.082, -0.045, 0.035), radius=0.02)
world.advance(1 / 60)
start = hand.position
for frame in range(60):
    hand.move_to(start + [0, 0, 0.02 * (frame + 1) / 60])
    report = world.advance(1 / 60)
    if not report.ok:
        raise SystemExit(report.conditions)
moment = world.snapshot()
print(f"lifted by 20 mm: {np.linalg.norm(hand.force):.2f} N, "
      f"the body has moved by up to {1e3 * np.linalg.norm(moment.u, axis=1).max():.1f} mm")
