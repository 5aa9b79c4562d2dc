"""Environments in which a program learns to operate, by the API of Gymnasium (docs/learn.md).

They need numpy alone. Where Gymnasium is installed they are its environments.
"""

from .cutting import Cutting
from .environment import Environment
from .palpation import Palpation
from .retraction import Retraction
from .spaces import Box
from .vector import Vector

__all__ = ["Box", "Cutting", "Environment", "Palpation", "Retraction", "Vector"]
