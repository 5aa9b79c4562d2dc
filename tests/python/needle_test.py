"""A needle that a script leads sews."""

import lobe
import numpy as np
import pytest

TOP, RADIUS = 0.02, 0.01
CENTRE = np.array([0.0203, 0.0198, TOP + 0.003])
SOFT = {
    "materials": [{"young_modulus": 20000, "poisson_ratio": 0.3, "density": 1000}],
    "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1e-6]}}}],
    "time": {"damping": 40},
}


def turned(phi):
    """The arc stands upright, and its tip is at phi: pi on the left, 3 pi / 2 deepest. A quaternion."""
    half = np.sqrt(0.5)  # about x by a quarter turn, of a turn about z by phi
    s, c = np.sin(phi / 2), np.cos(phi / 2)
    return half * c, -half * s, half * s, half * c


def needle(**more):
    return {"type": "needle", "radius": RADIUS, "puncture": 0.2, "friction": 20, "thread": 0,
            "thread_length": 0.2,
            "at": [*CENTRE, *turned(np.pi)], **more}


def test_a_needle_is_led_through_tissue_with_its_thread():
    world = lobe.World(lobe.Scene(SOFT, lobe.box_mesh((0.04, 0.04, TOP), (8, 8, 4))))
    hand = world.bring(needle())
    assert isinstance(hand, lobe.Needle) and hand.name == "needle" and hand.thread == 0
    assert (hand.tip, hand.inside, hand.free_length) == ("free", 0, None)
    tips, deepest, events = set(), 0, []
    for phi in np.linspace(np.pi, 3 * np.pi, 51)[1:]:
        hand.move_to(CENTRE, turned(phi))
        events += world.advance(0.01).events
        tips.add(hand.tip)
        deepest = max(deepest, hand.inside)
        if hand.tip == "inside":
            assert hand.torque[1] < 0
    assert tips == {"free", "pushing", "inside", "leaving"} or tips == {"free", "pushing", "inside"}
    assert 0.015 < deepest < np.pi * RADIUS
    assert [event.kind for event in events] == ["punctured", "exited"]
    assert all(0.2 <= event.size < 0.22 and abs(event.place[2] - TOP) < 0.006 for event in events)
    world.advance(0.01)
    assert len(world.threads) == 1
    before = hand.free_length
    for i in range(1, 21):
        hand.move_to(CENTRE + [0, 0, 0.004 * i], turned(3 * np.pi))
        world.advance(0.01)
    assert hand.free_length == pytest.approx(before - 0.08, abs=0.003)
    world.tie(0, 0, 1, tighten=0.002)
    hand.release()
    world.advance(0.3)
    assert max(max(thread["tensions"]) for thread in world.threads) > 0
    with pytest.raises(lobe.InputError, match="was let go already"):
        hand.tip


def test_what_a_needle_lacks_is_named():
    world = lobe.World(lobe.Scene(SOFT, lobe.box_mesh((0.04, 0.04, TOP), (2, 2, 1))))
    with pytest.raises(ValueError, match="/puncture"):
        world.bring(needle(puncture=0))
    with pytest.raises(ValueError, match="/thread_length"):
        world.bring(needle(thread_length=-1))
    with pytest.raises(ValueError, match="/ties: a hand ties by itself"):
        world.bring(needle(ties=[{"from": 0, "to": 1, "at": 0}]))
