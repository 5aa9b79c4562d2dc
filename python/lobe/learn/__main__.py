"""python3 -m lobe.learn [SECONDS]: what environments cost (cost.py)."""

import sys

from .cost import main

if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]))
