"""A flap hides what lies beneath it, and is to be pulled aside."""

import numpy as np

from .. import Scene, box_mesh
from .environment import Environment, unbounded
from .spaces import Box

LENGTH, THICK = 0.06, 0.006  # of the flap [m]


def _scene(stiffness):
    return Scene({
        "materials": [{"young_modulus": stiffness, "poisson_ratio": 0.4, "density": 1000, "element": "tetrahedron"}],
        "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [1e-6, 1, 1]}}}],
        "guard_below": 0.2,
        "time": {"damping": 30},
    }, box_mesh((LENGTH, LENGTH, THICK), (8, 8, 1)))


class Retraction(Environment):
    """Retract to expose: a grasper holds the free edge of a flap, and pulls it away from a field beneath it.

    Action: velocity of the grasper [m/s], at most 0.1 each. Observation: the way of the grasper since it
    took hold [m] (3), its force on the flap [N] (3), the share of the field that is seen from above (1).
    Reward: what more of it is seen, less 0.1 per newton above `gentle` [N]. Terminated when 95 % of it are
    seen.
    """

    def __init__(self, *, gentle=2.0, stiffness=2e4, **options):
        self.gentle = gentle
        self.action_space = Box(-0.1, 0.1, (3,))
        self.observation_space = unbounded(7)
        super().__init__(_scene(stiffness), **options)

    def bring(self, world):
        points = world.scene.mesh.points
        edge = (points[:, 0] > LENGTH - 1e-6) & (abs(points[:, 1] - LENGTH / 2) < 0.25 * LENGTH)
        world.grasp(edge, name="grasper")
        world.advance(self.frame)

    def begin(self):
        middle = LENGTH * (np.array([0.65, 0.5]) + self.np_random.uniform(-0.05, 0.05, 2))
        offsets = np.linspace(-0.15, 0.15, 5) * LENGTH
        self.field = np.stack(np.meshgrid(*(middle[:, None] + offsets)), -1).reshape(-1, 2)
        self._start = self.tools[0].position
        self.seen = self._share_seen()

    def act(self, action):
        self.tools[0].move_to(self.tools[0].position + self.frame * action)

    def observe(self):
        grasper = self.tools[0]
        return np.concatenate([grasper.position - self._start, grasper.force, [self.seen]])

    def judge(self, report):
        before, self.seen = self.seen, self._share_seen()
        force = np.linalg.norm(self.tools[0].force)
        return self.seen - before - 0.1 * max(0.0, force - self.gentle), self.seen >= 0.95

    def _share_seen(self):
        surface = self.world.snapshot().surface
        corners = surface.x[surface.triangles][:, :, :2]
        a, to_b, to_c = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = to_b[:, 0] * to_c[:, 1] - to_b[:, 1] * to_c[:, 0]
        kept = abs(area) > 1e-12
        a, to_b, to_c, area = a[kept], to_b[kept], to_c[kept], area[kept]
        way = self.field[:, None] - a
        b = (way[..., 0] * to_c[:, 1] - way[..., 1] * to_c[:, 0]) / area
        c = (to_b[:, 0] * way[..., 1] - to_b[:, 1] * way[..., 0]) / area
        return 1 - np.mean(((b >= 0) & (c >= 0) & (b + c <= 1)).any(axis=1))
