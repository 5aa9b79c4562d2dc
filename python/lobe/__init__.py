"""Organ mechanics in real time: linear and non-linear regions, tools and cuts (docs/python.md)."""

from ._lobe import (
    Cautery,
    Checkpoint,
    ClipApplier,
    Condition,
    Difference,
    Event,
    GestureOutcome,
    Grasp,
    InputError,
    Mesh,
    Probe,
    Proposal,
    Report,
    Scalpel,
    Scene,
    Snapshot,
    StaticResult,
    Surface,
    Transitions,
    World,
    __version__,
    box_mesh,
    compare,
    propose_regions,
    read_checkpoint,
    read_mesh,
    read_scene,
    region_models,
    run,
    solve,
)
from .programs import bench, fit, mesh, read_table, rest, sensitivity, view

__all__ = [
    "Cautery", "Checkpoint", "ClipApplier", "Condition", "Difference", "Event", "GestureOutcome", "Grasp",
    "InputError", "Mesh",
    "Probe", "Proposal", "Report", "Scalpel", "Scene", "Snapshot", "StaticResult",
    "Surface", "Transitions", "World", "__version__",
    "bench", "box_mesh", "compare", "fit", "mesh", "propose_regions", "read_checkpoint", "read_mesh", "read_scene",
    "read_table", "region_models", "rest", "run", "sensitivity", "solve", "view",
]
