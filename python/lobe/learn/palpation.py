"""Something stiff is hidden in a block of tissue, and is to be found by touch."""

import numpy as np

from .. import Scene, box_mesh
from .environment import Environment, unbounded
from .spaces import Box

SIZE, HEIGHT, RADIUS, TIP = 0.06, 0.024, 0.009, 0.008  # block, lump, and ball of the probe [m]
PLACES = np.stack(np.meshgrid([0.015, 0.03, 0.045], [0.015, 0.03, 0.045]), -1).reshape(-1, 2)


def _scene(place, contrast):
    lump = {"sphere": {"center": [*map(float, place), HEIGHT - RADIUS], "radius": RADIUS}}
    soft = {"young_modulus": 1e4, "poisson_ratio": 0.4, "density": 1000, "element": "tetrahedron"}
    return Scene({
        "materials": [dict(soft, young_modulus=1e4 * contrast, where=lump), soft],
        "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1e-6]}}}],
        "guard_below": 0.2,
        "time": {"damping": 30},
    }, box_mesh((SIZE, SIZE, HEIGHT), (9, 9, 4)))


class Palpation(Environment):
    """Palpate and find: a ball on a stick touches a block in which a lump of `contrast` times the stiffness
    is hidden.

    Action: velocity of the ball [m/s] (3), at most 0.2 each, and a number that is above 0.5 to say "it is
    here" (1). Observation: place of the ball [m] (3), force on it [N] (3). Reward: 1 if the place said is
    within 8 mm of the lump, seen from above, else -1. Terminated when a place is said. info["place"]: where
    the lump is [m].
    """

    near = 0.008  # [m]

    def __init__(self, *, contrast=10.0, **options):
        self.action_space = Box(np.array([-0.2, -0.2, -0.2, -1]), np.array([0.2, 0.2, 0.2, 1]))
        self.observation_space = unbounded(6)
        self._scenes = [_scene(place, contrast) for place in PLACES]
        super().__init__(self._scenes[0], **options)

    def choose(self):
        self._lump = int(self.np_random.integers(len(PLACES)))
        self.use(self._scenes[self._lump])

    def bring(self, world):
        world.bring({"type": "probe", "shape": {"sphere": {"radius": TIP}}, "friction": 0, "name": "probe",
                     "at": [SIZE / 2, SIZE / 2, HEIGHT + 2 * TIP]})
        world.advance(self.frame)

    def begin(self):
        self.place = np.array([SIZE / 2, SIZE / 2, HEIGHT + 2 * TIP])
        self._says_here = False

    def act(self, action):
        low, high = np.array([0, 0, HEIGHT]), np.array([SIZE, SIZE, 2 * HEIGHT])
        self.place = np.clip(self.place + self.frame * action[:3], low, high)
        self.tools[0].move_to(self.place)
        self._says_here = action[3] > 0.5

    def observe(self):
        return np.concatenate([self.place, -self.tools[0].force])

    def judge(self, report):
        if not self._says_here:
            return 0.0, False
        is_right = np.linalg.norm(self.place[:2] - PLACES[self._lump]) <= self.near
        return (1.0 if is_right else -1.0), True

    def info(self):
        return dict(super().info(), place=PLACES[self._lump])
