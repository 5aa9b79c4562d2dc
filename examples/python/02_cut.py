"""Burns a notch into the liver and weighs what is left; the surface tells which triangles the cut has made.

    PYTHONPATH=build/python /usr/bin/python3 examples/python/02_cut.py
    burnt: 41 tetrahedra, left: 2062; 27 of 682 triangles are of the cut
"""

import pathlib

import lobe

DATA = pathlib.Path(__file__).parents[2] / "data"
mesh = lobe.read_mesh(DATA / "meshes" / "liver_2k.vtu")
scene = lobe.Scene({
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "boundary": [{"fix": True, "where": {"box": {"min": [-1, 0.015, -1], "max": [-0.02, 1, 1]}}}],
    "time": {"damping": 20},
}, mesh)
world = lobe.World(scene)

tip = world.cautery((0.03, -0.06, 0.03), radius=0.008)
tip.switch(True)
burnt = 0
for frame in range(30):
    tip.move_to((0.03, -0.06 + 0.001 * (frame + 1), 0.03))
    burnt += world.advance(1 / 60).tets_removed
tip.release()
surface = world.snapshot().surface
print(f"burnt: {burnt} tetrahedra, left: {world.tet_count}; "
      f"{surface.cut.sum()} of {len(surface.triangles)} triangles are of the cut")
