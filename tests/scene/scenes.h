// Scenes as text, for the tests of this folder.
#pragma once

#include <string>

namespace lobe {

// Every key and every selector of the format.
inline const std::string full_scene = R"({
  "$schema": "scene.schema.json",
  "name": "liver",
  "comment": "every key",
  "mesh": "meshes/liver.vtu",
  "mesh_scale": 0.001,
  "materials": [
    {"name": "parenchyma", "lame_lambda": 4e4, "lame_mu": 1e4, "density": 1060, "fracture_energy": 150,
     "viscosity": [{"shear": 0.3, "bulk": 0.1, "time": 0.05}]},
    {"name": "tumour", "where": {"label": 2}, "young_modulus": 7e4, "poisson_ratio": 0.4, "nodal_pressure": true, "element": "edge-smoothed"},
    {"where": {"label": [3, 4]}, "lame_lambda": 0, "lame_mu": 1e3, "nodal_pressure": 0.5}
  ],
  "volume_penalty": 1e5,
  "guard_below": 0.2,
  "regions": [
    {"name": "held part", "model": "precomputed", "frame": "corotated", "where": {"box": {"min": [-0.1, -0.2, -0.3], "max": [0, 0.1, 0.2]}}},
    {"model": "tensor-mass", "where": {"sphere": {"center": [0.01, 0, 0], "radius": 0.02}}},
    {"model": "tensor-mass", "where": {"any_of": [{"tetrahedra": [1, 2]}, {"not": {"all": true}}]}},
    {"name": "free part", "model": "nonlinear"}
  ],
  "boundary": [
    {"fix": true, "where": {"all_of": [{"all": true}, {"plane": {"point": [0, 0, 0], "normal": [0, 0, 2], "side": "below"}}]}},
    {"displacement": [0.01, 0, 0], "where": {"vertices": [12, 13]}},
    {"traction": [0, 0, -120], "where": {"plane": {"point": [0.1, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}},
    {"force": [0, 0, -1.5], "where": {"nearest": {"point": [0.1, 0, 0], "count": 20}}}
  ],
  "gravity": [0, 0, -9.81],
  "tools": [
    {"name": "grasper", "type": "grasp", "where": {"sphere": {"center": [0.1, 0, 0], "radius": 0.01}},
     "path": [[0.0, 0, 0, 0], [1.0, 0, 0.05, 0.02]], "release": true},
    {"type": "cautery", "radius": 0.006, "path": [[0.5, 0.03, -0.05, 0], [1.5, 0.03, 0.05, 0]]},
    {"type": "scalpel", "snap": 0.2, "surface": "faces", "path": [[0.5, 0.03, -0.05, 0, 0.04, -0.05, 0.1], [1.5, 0.03, 0.05, 0, 0.04, 0.05, 0.1]]}
  ],
  "threads": [
    {"name": "3-0", "stiffness": 80, "friction": 0.1, "strength": 20, "holds": 1.5,
     "stitches": [{"through": [[0, 0, 0], [0.01, 0, 0], [0.02, 0, 0]], "at": 0.5, "tie": [{"at": 0.75, "tighten": 0.002, "over": 0.1, "between": [0, 1]}, {"at": 1}]},
                  {"through": [[0, 0, 0.01], [0.01, 0, 0.01]], "tie": {"at": 0.25}}]}
  ],
  "attachments": [
    {"name": "bed", "softening": 4, "bed": {"from": {"label": 1}, "to": {"label": 2}, "within": 0.004, "spacing": 0.0025, "stiffness": 7e6, "fracture_energy": 50}},
    {"name": "wall", "bed": {"from": {"label": 2}, "to_world": true, "stiffness": 1e6}},
    {"name": "round ligament", "ligament": {"from": [0, 0, 0], "to": [0.01, 0, 0], "stiffness": 300, "slack": 0.002, "strength": 4}},
    {"name": "suspension", "ligament": {"from": [0, 0, 0], "to_world": [0, 0, 0.1], "stiffness": 200}}
  ],
  "loose_pieces": "vanish",
  "skin": "skin.obj",
  "time": {"duration": 2.0, "frame": 0.02, "damping": 20, "safety": 0.8, "cut_step": 0.5, "selective_mass": 9,
           "ramp": 0.25, "load_ramp": 0.5, "sleep": 1e-5, "own_steps": true, "precision": "double",
           "integrator": "implicit", "step": 0.005, "spectral_radius": 1.0},
  "output": {"every": 0.04, "pictures": [0.5, 1.5]}
})";

}  // namespace lobe
