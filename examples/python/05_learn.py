"""A task of one's own as an environment: a hand is to bring a beam's end to a target.

    PYTHONPATH=build/python /usr/bin/python3 examples/python/05_learn.py
    gain  2.0: 76.0 steps to the target
    gain 10.0: 15.4 steps to the target
"""

import lobe
import numpy as np
from lobe import learn


class Reach(learn.Environment):
    """Action: velocity of the hand [m/s]. Observation: way from the end to the target [m], force [N]."""

    action_space = learn.Box(-0.1, 0.1, (3,))
    observation_space = learn.Box(-np.inf, np.inf, (6,))

    def __init__(self):
        super().__init__(lobe.Scene({
            "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
            "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}],
            "time": {"damping": 20},
        }, lobe.box_mesh((0.1, 0.02, 0.02), (8, 2, 2))), longest=200)

    def bring(self, world):
        world.grasp(world.scene.mesh.points[:, 0] > 0.099)
        world.advance(self.frame)

    def begin(self):
        self.target = self.tools[0].position + self.np_random.uniform(-0.02, 0.02, 3)

    def act(self, action):
        self.tools[0].move_to(self.tools[0].position + self.frame * action)

    def observe(self):
        return np.concatenate([self.target - self.tools[0].position, self.tools[0].force])

    def judge(self, report):
        distance = np.linalg.norm(self.target - self.tools[0].position)
        return -distance, distance < 1e-3


task = Reach()
for gain in (2.0, 10.0):  # two policies: the velocity is so many times the way that is left
    steps = []
    for episode in range(5):
        observation, _ = task.reset(seed=episode)
        is_over = False
        while not is_over:
            observation, reward, terminated, truncated, _ = task.step(gain * observation[:3])
            is_over = terminated or truncated
        steps.append(task.steps)
    print(f"gain {gain:4.1f}: {np.mean(steps):.1f} steps to the target")
