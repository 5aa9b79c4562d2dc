"""Handles of tools, and what becomes of them."""

import conftest
import lobe
import numpy as np
import pytest

USES = {
    "Grasp": [lambda t: t.move_to((0, 0, 0)), lambda t: t.release(), lambda t: t.name, lambda t: t.vertices,
              lambda t: t.position, lambda t: t.force, lambda t: t.torque],
    "Cautery": [lambda t: t.move_to((0, 0, 0)), lambda t: t.switch(True), lambda t: t.release(), lambda t: t.name],
    "Probe": [lambda t: t.move_to((0, 0, 0)), lambda t: t.switch(True), lambda t: t.release(),
              lambda t: t.name, lambda t: t.force, lambda t: t.torque, lambda t: t.grip],
    "Scalpel": [lambda t: t.move_to((0, 0, 0)), lambda t: t.switch(True), lambda t: t.release(), lambda t: t.name],
}


def all_tools(world, tip):
    return [world.grasp(tip, name="left"), world.cautery((0, 0, 1), radius=0.01),
            world.scalpel((0, 0, 1), (0, 0, 2)),
            world.bring({"type": "probe", "shape": {"sphere": {"radius": 0.001}}, "at": [0, 0, 1]})]


def test_a_handle_of_before_a_restore_says_so(scene, tip):
    world = lobe.World(scene)
    empty = world.save()
    handles = all_tools(world, tip)
    world.advance(0.01)
    full = world.save()
    for checkpoint in (empty, full):
        world.restore(checkpoint)
        new = all_tools(world, tip)  # with the same numbers, after the first restore
        world.advance(0.01)
        before = world.snapshot().u
        for handle in handles:
            for use in USES[type(handle).__name__]:
                with pytest.raises(lobe.InputError, match=r"made before World\.restore\(\)"):
                    use(handle)
            assert "of before a restore()" in repr(handle)
        assert (world.snapshot().u == before).all() and new[0].name == "left" and (new[0].vertices == tip).all()
        handles += new


def test_a_restore_that_is_refused_leaves_the_handles(scene, tip):
    world = lobe.World(scene)
    grasp = world.grasp(tip)
    world.advance(0.01)
    with pytest.raises(lobe.InputError, match="precision"):
        world.restore(lobe.World(scene, precision="single").save())
    assert (grasp.vertices == tip).all()


def test_a_world_has_handles_of_its_tools(scene, tip):
    world = lobe.World(scene)
    assert world.tools == []
    all_tools(world, tip)
    world.advance(0.01)
    kept = world.save()
    assert [type(tool) for tool in world.tools] == [lobe.Grasp, lobe.Cautery, lobe.Scalpel, lobe.Probe]
    assert [tool.name for tool in world.tools] == ["left", "cautery", "scalpel", "probe"]
    for tool in world.tools:
        tool.release()
    world.advance(0.01)
    assert world.tools == []
    other = lobe.World(scene)
    other.restore(kept)
    grasp = other.tools[0]
    start = grasp.position
    grasp.move_to(start + [0, 0, 0.001])
    assert other.advance(0.01).ok
    assert grasp.position == pytest.approx(start + [0, 0, 0.001], rel=1e-12)


def test_a_tool_that_was_let_go_says_so(scene, tip):
    world = lobe.World(scene)
    for tool in all_tools(world, tip):
        tool.release()
        with pytest.raises(lobe.InputError, match="was let go"):
            tool.move_to((0, 0, 0))
    assert np.isfinite(world.time)


def test_a_probe_presses_and_jaws_close(mesh):
    world = lobe.World(lobe.Scene(dict(conftest.BEAM, gravity=[0, 0, 0]), mesh))
    probe = world.bring({"type": "probe", "name": "tip", "shape": {"sphere": {"radius": 0.005}},
                         "friction": 0.3, "at": [0.08, 0.01, 0.026]})
    assert isinstance(probe, lobe.Probe) and probe.name == "tip"
    world.advance(0.01)
    assert (probe.force == 0).all()
    for frame in range(10):
        probe.move_to((0.08, 0.01, 0.026 - 0.0005 * (frame + 1)))
        assert world.advance(0.01).ok
    assert probe.force[2] < -0.01
    jaws = world.bring({"type": "probe", "shape": {"jaws": {"size": [0.004, 0.012, 0.002]}},
                        "at": [0.03, 0.01, 0.01, 0, 0, 0, 1, 0.03]})
    jaws.switch(True)
    for _ in range(60):
        assert world.advance(0.01).ok
    assert jaws.grip > 0
    jaws.release()
    with pytest.raises(lobe.InputError, match="was let go"):
        jaws.grip


def test_a_tool_that_no_scene_may_have_is_refused_by_name(scene):
    world = lobe.World(scene)
    for tool, place in (({"type": "probe", "shape": {"sphere": {"radius": 0}}, "at": [0, 0, 1]},
                         "/shape/sphere/radius"),
                        ({"type": "grasp", "where": {"vertices": [0]}, "at": [0, 0, 1]}, "/type"),
                        ({"type": "cautery", "radius": 0.01}, "/at"),
                        ({"type": "cautery", "radius": 0.01, "at": [0]}, "/at"),
                        ({"type": "cautery", "radius": 0.01, "at": [0, 0, 1], "path": []}, "/path"),
                        ({"type": "scalpel", "at": [0, 0, 1]}, "/at")):
        with pytest.raises(lobe.InputError) as raised:
            world.bring(tool)
        assert raised.value.faults[0][0] == place, raised.value
    assert world.tools == []
