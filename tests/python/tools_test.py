"""Handles of tools, and what becomes of them."""

import lobe
import numpy as np
import pytest

USES = {
    "Grasp": [lambda t: t.move_to((0, 0, 0)), lambda t: t.release(), lambda t: t.name, lambda t: t.vertices,
              lambda t: t.position, lambda t: t.force, lambda t: t.torque],
    "Cautery": [lambda t: t.move_to((0, 0, 0)), lambda t: t.switch(True), lambda t: t.release(), lambda t: t.name],
    "Scalpel": [lambda t: t.move_to((0, 0, 0)), lambda t: t.switch(True), lambda t: t.release(), lambda t: t.name],
}


def all_tools(world, tip):
    return [world.grasp(tip, name="left"), world.cautery((0, 0, 1), radius=0.01), world.scalpel((0, 0, 1), (0, 0, 2))]


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
    assert [type(tool) for tool in world.tools] == [lobe.Grasp, lobe.Cautery, lobe.Scalpel]
    assert [tool.name for tool in world.tools] == ["left", "cautery", "scalpel"]
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
