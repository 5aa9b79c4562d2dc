"""A task on an organ as an environment."""

import numpy as np

from .. import World
from .spaces import Box, Env


class Environment(Env):
    """A world with tools that an agent leads: reset(), then step(action) until it is terminated or truncated.

    A task derives from it. It has the attributes action_space and observation_space, and

    - bring(world) brings the tools; called once per world;
    - begin() starts an episode, with self.np_random and self.tools, the handles of these tools;
    - act(action) leads them; actions are within their bounds;
    - observe() returns an array;
    - judge(report) returns (reward, terminated) of a frame, by its lobe.Report.

    reward: a function of (environment, report) in place of the task's reward.
    frame [s]: how long a step is. longest: steps until an episode is truncated.
    """

    def __init__(self, scene, *, frame=0.02, longest=500, reward=None):
        if not frame > 0 or not longest >= 1:
            raise ValueError(f"frame and longest must be above 0, not {frame} s and {longest}")
        self.frame = frame
        self.longest = longest
        self.steps = 0
        self._reward = reward
        self._is_over = True
        self._begin = {}
        self.use(scene)

    def use(self, scene):
        """Goes on with the world of a scene. It is built when it is used first."""
        if id(scene) not in self._begin:
            world = World(scene)
            self.bring(world)
            self._begin[id(scene)] = scene, world, world.save()  # the scene is kept: its id stays its own
        _, self.world, self._first = self._begin[id(scene)]

    def reset(self, *, seed=None, options=None):
        """Puts the world back to where it began, and returns (observation, info)."""
        super().reset(seed=seed)
        self.choose()
        self.world.restore(self._first)
        self.tools = self.world.tools
        self.steps = 0
        self._is_over = False
        self.begin()
        return self._observation(), self.info()

    def step(self, action):
        """Returns (observation, reward, terminated, truncated, info). ValueError: that is no action."""
        if self._is_over:
            raise ValueError("the episode is over, or has not begun: call reset()")
        action = np.asarray(action, dtype=float)
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            raise ValueError(f"an action is {self.action_space}, not {action!r}")
        self.act(np.clip(action, self.action_space.low, self.action_space.high))
        report = self.world.advance(self.frame)
        self.steps += 1
        reward, terminated = self.judge(report)
        if self._reward is not None:
            reward = self._reward(self, report)
        truncated = not terminated and (self.steps >= self.longest or not report.ok)
        self._is_over = terminated or truncated
        return self._observation(), float(reward), bool(terminated), bool(truncated), self.info()

    def choose(self):
        """What comes before the world is put back: which world, for example."""

    def info(self):
        """What is no observation: the time [s], and whatever a task adds."""
        return {"time": self.world.time}

    def _observation(self):
        return np.asarray(self.observe(), dtype=self.observation_space.dtype)


def unbounded(count):
    """The space of that many numbers."""
    return Box(-np.inf, np.inf, (count,))
