"""A line is drawn on a block of tissue, which is to be cut along it."""

import numpy as np

from .. import Scene, box_mesh
from .environment import Environment, unbounded
from .spaces import Box

LENGTH, WIDTH, HEIGHT = 0.06, 0.04, 0.012  # of the block [m]
BLADE, DEPTH = 0.03, 0.005                 # of the blade, and of the cut that is asked for [m]


def _scene():
    return Scene({
        "materials": [{"young_modulus": 1e4, "poisson_ratio": 0.4, "density": 1000, "element": "tetrahedron"}],
        "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1e-6]}}}],
        "guard_below": 0.2,
        "time": {"damping": 30},
    }, box_mesh((LENGTH, WIDTH, HEIGHT), (9, 6, 2)))


class Cutting(Environment):
    """Cut along a line: an upright blade opens a block from the line's start to its end, 5 mm deep.

    Action: velocity of the blade's tip [m/s], at most 0.2 each. Observation: place of the tip (3), start
    and end of the line on the surface (2 and 2) [m]. Reward: by what the share of the line that is cut has
    grown, less the area [cm²] that was opened more than 2 mm beside it. Of the line counts what the tip has
    passed 5 mm deep, as far as the area that was opened allows. Tissue opens tetrahedron by tetrahedron,
    somewhat later. Terminated when the share is 95 %. info["beside"]: the area beside the line in all [m²].
    """

    width, parts = 0.002, 40  # of what counts as on the line [m]; into which it is divided

    def __init__(self, **options):
        self.action_space = Box(-0.2, 0.2, (3,))
        self.observation_space = unbounded(7)
        super().__init__(_scene(), **options)

    def bring(self, world):
        tip = np.array([0.5 * LENGTH, 0.5 * WIDTH, 2 * HEIGHT])
        world.scalpel(tip, tip + [0, 0, BLADE], name="scalpel").switch(True)
        world.advance(self.frame)

    def begin(self):
        self.place = np.array([0.5 * LENGTH, 0.5 * WIDTH, 2 * HEIGHT])
        slope = self.np_random.uniform(-0.006, 0.006)
        self.start = np.array([0.2 * LENGTH, 0.5 * WIDTH - slope])
        self.end = np.array([0.8 * LENGTH, 0.5 * WIDTH + slope])
        self._passed = np.zeros(self.parts, bool)
        self._opened = self.beside = self.share = 0.0

    def act(self, action):
        self._before = self.place
        low, high = np.array([-0.02, -0.02, 0.001]), np.array([LENGTH + 0.02, WIDTH + 0.02, 3 * HEIGHT])
        self.place = np.clip(self.place + self.frame * action, low, high)
        self.tools[0].move_to(self.place)

    def observe(self):
        return np.concatenate([self.place, self.start, self.end])

    def judge(self, report):
        for share in np.linspace(0, 1, 9):
            self._mark(self._before + share * (self.place - self._before))
        if report.cut_area > 0 and self._beside(self.place) > self.width:
            self.beside += report.cut_area
            return -1e4 * report.cut_area, False
        before = self.share
        self._opened += report.cut_area
        asked = DEPTH * np.linalg.norm(self.end - self.start)
        self.share = min(np.mean(self._passed), self._opened / asked)
        return self.share - before, self.share >= 0.95

    def info(self):
        return dict(super().info(), beside=self.beside)

    def _beside(self, place):  # how far from the line, seen from above [m]
        x, y = self.end - self.start
        way = place[:2] - self.start
        return abs(x * way[1] - y * way[0]) / np.hypot(x, y)

    def _mark(self, place):
        way = self.end - self.start
        along = (place[:2] - self.start) @ way / (way @ way)
        if place[2] <= HEIGHT - DEPTH and 0 <= along <= 1 and self._beside(place) <= self.width:
            self._passed[min(int(along * self.parts), self.parts - 1)] = True
