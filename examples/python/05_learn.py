"""A task in the form of a gym environment: reset(), step(action). A hand is to bring a beam's end to a target.

    PYTHONPATH=build/python /usr/bin/python3 examples/python/05_learn.py
"""

import lobe
import numpy as np


class Reach:
    """action: velocity of the hand [m/s]; observation: the way from the end to the target [m] and the force [N]."""

    def __init__(self):
        self.mesh = lobe.box_mesh((0.1, 0.02, 0.02), (8, 2, 2))
        self.end = np.flatnonzero(self.mesh.points[:, 0] > 0.099)
        scene = lobe.Scene({
            "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
            "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}],
            "time": {"damping": 20},
        }, self.mesh)
        self.world = lobe.World(scene)
        self.begin = self.world.save()

    def reset(self, seed):
        self.world.restore(self.begin)  # much cheaper than a new world
        self.hand = self.world.grasp(self.end)
        self.world.advance(0.02)
        self.target = self.hand.position + np.random.default_rng(seed).uniform(-0.02, 0.02, 3)
        return self._observe()

    def step(self, action):
        self.hand.move_to(self.hand.position + 0.02 * np.clip(action, -0.1, 0.1))
        report = self.world.advance(0.02)
        observation = self._observe()
        distance = np.linalg.norm(observation[:3])
        return observation, -distance, bool(distance < 1e-3), not report.ok

    def _observe(self):
        return np.concatenate([self.target - self.hand.position, self.hand.force])


task = Reach()
for gain in (2.0, 10.0):  # two policies: the velocity is so many times the way that is left
    steps = []
    for episode in range(5):
        observation, count, done = task.reset(seed=episode), 0, False
        while not done and count < 200:
            observation, reward, done, failed = task.step(gain * observation[:3])
            count += 1
        steps.append(count)
    print(f"gain {gain:4.1f}: {np.mean(steps):.1f} steps to the target")
