"""What environments cost.

Steps of 1/50 s per second of processor time, and the time that a reset takes [µs]: of the tasks, and of a
block of 2,058 tetrahedra of which a corner is led. Then how many times as many steps two environments take
at once.
"""

import functools
import time

import numpy as np

from .. import Scene, box_mesh
from . import Box, Cutting, Environment, Palpation, Retraction, Vector


class Block(Environment):
    """A block that is held on one side, and led by a corner. Observation: its place [m] and force [N]."""

    def __init__(self):
        self.action_space, self.observation_space = Box(-0.05, 0.05, (3,)), Box(-np.inf, np.inf, (6,))
        super().__init__(Scene({
            "materials": [{"young_modulus": 1e4, "poisson_ratio": 0.4, "element": "tetrahedron"}],
            "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [1e-6, 1, 1]}}}],
            "time": {"damping": 20},
        }, box_mesh((0.07, 0.07, 0.07), (7, 7, 7))), longest=100)

    def bring(self, world):
        world.grasp(np.linalg.norm(world.scene.mesh.points - 0.07, axis=1) < 0.02)
        world.advance(self.frame)

    def begin(self):
        pass

    def act(self, action):
        self.tools[0].move_to(self.tools[0].position + self.frame * action)

    def observe(self):
        return np.concatenate([self.tools[0].position, self.tools[0].force])

    def judge(self, report):
        return 0.0, False


def measure(environment, seconds):
    """Steps per second of processor time, and the processor time of a reset after a step [s]."""
    resets, steps, spent = [], 0, 0.0
    environment.action_space.seed(1)
    while spent < seconds:
        before = time.process_time()
        environment.reset(seed=steps)
        resets.append(time.process_time() - before)
        is_over = False
        before = time.process_time()
        while not is_over:
            _, _, terminated, truncated, _ = environment.step(environment.action_space.sample())
            is_over = terminated or truncated
            steps += 1
        spent += time.process_time() - before
    return steps / spent, np.median(resets)


def gain(workers, seconds):
    """How many times as many steps two take as one, in the same time."""
    rates = []
    for count in (1, 2):
        with Vector([Block] * count, workers=workers) as vector:
            vector.reset(seed=1)
            steps, began = 0, time.perf_counter()
            while time.perf_counter() - began < seconds:
                vector.step(np.zeros((count, 3)))
                steps += count
            rates.append(steps / (time.perf_counter() - began))
    return rates[1] / rates[0]


def main(seconds=2.0):
    """Prints it. seconds: how long each is measured."""
    print(f"{'environment':<12} {'tetrahedra':>10} {'steps/s':>9} {'reset [us]':>11}")
    short = [functools.partial(Palpation, longest=100), functools.partial(Cutting, longest=50)]
    for make in (Block, Retraction, *short):
        environment = make()
        rate, reset = measure(environment, seconds)
        name = type(environment).__name__
        print(f"{name:<12} {len(environment.world.scene.mesh.tets):>10} {rate:>9.0f} {1e6 * reset:>11.0f}")
    for workers in ("threads", "processes"):
        print(f"two blocks in {workers}: {gain(workers, seconds):.2f} times the steps of one")

