"""What actions and observations may be: classes of Gymnasium, or such that do the same for these tasks."""

import numpy as np

try:
    from gymnasium import Env
    from gymnasium.spaces import Box
except ImportError:

    class Env:
        """What an environment has that Gymnasium would give it."""

        metadata = {"render_modes": []}
        render_mode = None
        spec = None
        _random = None

        @property
        def np_random(self):
            """The generator of random numbers that reset(seed) starts."""
            if self._random is None:
                self._random = np.random.default_rng()
            return self._random

        def reset(self, *, seed=None, options=None):
            """Starts the generator again if there is a seed."""
            if seed is not None:
                self._random = np.random.default_rng(seed)

        @property
        def unwrapped(self):
            """The environment itself."""
            return self

        def close(self):
            """Does nothing."""

    class Box:
        """Arrays of one shape between two bounds."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            if shape is None:
                shape = np.broadcast(np.asarray(low), np.asarray(high)).shape
            self.shape = tuple(shape)
            self.dtype = np.dtype(dtype)
            self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape).copy()
            self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape).copy()
            self.seed(seed)

        def seed(self, seed=None):
            """Starts its generator of random numbers again."""
            self._random = np.random.default_rng(seed)

        def sample(self):
            """A random one, uniform where it is bounded, else normal."""
            bounded = np.isfinite(self.low) & np.isfinite(self.high)
            drawn = self._random.normal(size=self.shape)
            inside = self._random.uniform(np.where(bounded, self.low, 0), np.where(bounded, self.high, 1))
            return np.clip(np.where(bounded, inside, drawn), self.low, self.high).astype(self.dtype)

        def contains(self, x):
            """Whether it is one of them."""
            x = np.asarray(x)
            return bool(x.shape == self.shape and np.can_cast(x.dtype, self.dtype)
                        and np.all(x >= self.low) and np.all(x <= self.high))

        def __contains__(self, x):
            return self.contains(x)

        def __eq__(self, other):
            return (isinstance(other, Box) and self.shape == other.shape and self.dtype == other.dtype
                    and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high))

        def __repr__(self):
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"
