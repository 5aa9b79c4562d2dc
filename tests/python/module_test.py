"""All that the module offers says what it is."""

import inspect
import re

import conftest
import lobe
import numpy as np
import pytest

CLASSES = {name: value for name, value in vars(lobe).items() if inspect.isclass(value) and name != "InputError"}


def text_of(thing):
    """Its docstring without the signature."""
    return re.sub(r"^\w+\(.*\) -> .*\n\n", "", thing.__doc__ or "").strip()


def documented():
    for name in lobe.__all__:
        value = getattr(lobe, name)
        if name in ("__version__", "region_models"):
            continue
        yield name, value
        if inspect.isclass(value) and name != "InputError":
            for member, of in vars(value).items():
                if not member.startswith("_"):
                    yield f"{name}.{member}", of
            if "__init__" in vars(value) and "(self" in (value.__init__.__doc__ or ""):
                yield f"{name}()", value.__init__


@pytest.mark.parametrize("name, thing", documented())
def test_everything_has_a_sentence(name, thing):
    text = text_of(thing)
    assert len(text.split()) >= 3, f"{name}: {text!r}"
    assert text.endswith("."), f"{name}: {text!r}"
    assert not text[0].islower(), f"{name}: {text!r}"


def test_the_module_exports_all_its_classes():
    ours = {name for name, value in vars(lobe._lobe).items() if inspect.isclass(value)}
    assert ours == set(CLASSES) | {"InputError"} and ours <= set(lobe.__all__)


def test_every_class_says_what_it_is(mesh, scene, tip):
    world = lobe.World(scene)
    grasp, cautery = world.grasp(tip), world.cautery((0, 0, 1), radius=0.01)
    scalpel = world.scalpel((0, 0, 1), (0, 0, 2))
    probe = world.bring({"type": "probe", "shape": {"sphere": {"radius": 0.001}}, "at": [0, 0, 1]})
    clip = {"type": "clip_applier", "length": 0.006, "opening": 0.005, "gap": 0.002, "at": [0, 0, 1]}
    applier = world.bring(clip)
    needle = world.bring({"type": "needle", "radius": 0.01, "puncture": 1, "friction": 20, "at": [0, 0, 1]})
    assert "takes hold in the next frame" in repr(grasp)
    report = world.advance(0.01)
    moment = world.snapshot()
    static = lobe.solve(scene)
    force = {"name": "poke", "vertices": tip, "force": [0, 0, 0.001]}
    still = lobe.Scene(dict(conftest.BEAM, gravity=[0, 0, 0]), mesh)
    proposal = lobe.propose_regions(still, 0.05, gestures=[force])
    torn = lobe.World(scene)
    torn.set_forces(tip, np.full((len(tip), 3), 1e5))
    conditions = torn.advance(0.01).conditions
    tied = lobe.World(scene)
    tied.attach("hair", [(0.09, 0.01, 0.01)], [(0.09, 0.01, 0.02)], stiffness=1, strength=1e-9, to_world=True)
    events = tied.advance(0.05).events
    instances = [world, grasp, cautery, scalpel, probe, applier, needle, report, report.transitions, moment,
                 moment.surface,
                 static, lobe.compare(mesh, static.u, static.u), proposal, proposal.gestures[0], mesh, scene, world.save(),
                 *conditions[:1], *events[:1]]
    assert {type(instance).__name__ for instance in instances} == set(CLASSES) - {"Tool"}  # their base
    assert all(isinstance(tool, lobe.Tool) for tool in (grasp, cautery, scalpel, probe, applier, needle))
    for instance in instances:
        text = repr(instance)
        assert text.startswith("<lobe." + type(instance).__name__) and text.endswith(">"), text
        assert " at 0x" not in text and "\n" not in text
    assert repr(world) == "<lobe.World: 0.01 s, 192 tetrahedra, double precision>"
    assert repr(scene) == "<lobe.Scene: 192 tetrahedra in memory>"
    assert 'Grasp "hand": it holds on' in repr(grasp) and "it is off" in repr(cautery)
    scalpel.switch(True)
    assert "it is on" in repr(scalpel)
    scalpel.release()
    assert "was let go" in repr(scalpel)
    applier.switch(True)
    assert "its jaws are closed" in repr(applier) and world.clips == [] and world.carriers == []
