"""Fits λ and μ to forces that were measured at a short block's end in three pulls, here made by lobe with 1 % of noise.

    PYTHONPATH=build/python /usr/bin/python3 examples/python/04_fit_material.py
    λ = 39.7 kPa (40 were put in), μ = 10.08 kPa (10)
"""

import lobe
import numpy as np
from scipy.optimize import least_squares

mesh = lobe.box_mesh((0.03, 0.06, 0.06), (2, 4, 4))
end = np.flatnonzero(mesh.points[:, 0] > 0.0299)
pulls = np.array([[0.003, 0, 0], [0, 0.003, 0], [-0.003, 0, 0]])  # of the end [m]


def energy(material, pull):
    """Of the block in equilibrium [J]."""
    return lobe.solve(lobe.Scene({
        "materials": [{"lame_lambda": material[0], "lame_mu": material[1]}],
        "boundary": [
            {"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}},
            {"displacement": pull, "where": {"vertices": end}},
        ],
    }, mesh)).energy


def forces(material):
    """Along each pull, on the end [N]: the derivative of the energy, by central differences."""
    h = 0.01
    gains = [energy(material, (1 + h) * pull) - energy(material, (1 - h) * pull) for pull in pulls]
    return np.array(gains) / (2 * h * np.linalg.norm(pulls, axis=1))


true = np.array([4e4, 1e4])  # [Pa]
measured = forces(true) * (1 + 0.01 * np.random.default_rng(1).standard_normal(len(pulls)))
fit = least_squares(lambda log: forces(np.exp(log)) / measured - 1, np.log([1e4, 2e4]), diff_step=1e-3)
found = np.exp(fit.x)
print(f"λ = {found[0] / 1e3:.1f} kPa (40 were put in), μ = {found[1] / 1e3:.2f} kPa (10)")
