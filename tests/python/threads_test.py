"""A thread that looks at a world while another one advances it is refused, whatever it looks at."""

import threading

import lobe

LOOKS = {
    "time": lambda world, hand: world.time,
    "tet_count": lambda world, hand: world.tet_count,
    "vertex_count": lambda world, hand: world.vertex_count,
    "tools": lambda world, hand: world.tools,
    "snapshot": lambda world, hand: world.snapshot(),
    "energies": lambda world, hand: world.energies(),
    "save": lambda world, hand: world.save(),
    "remove_tets": lambda world, hand: world.remove_tets([0]),
    "grasp": lambda world, hand: world.grasp([0]),
    "name": lambda world, hand: hand.name,
    "vertices": lambda world, hand: hand.vertices,
    "position": lambda world, hand: hand.position,
    "force": lambda world, hand: hand.force,
    "torque": lambda world, hand: hand.torque,
}


def test_every_look_is_refused_while_another_thread_advances(scene, tip):
    world = lobe.World(scene)
    hand = world.grasp(tip)
    world.advance(0.01)
    has_begun, refused, reports = threading.Event(), set(), []

    def advance():
        has_begun.set()
        while not reports:
            try:
                reports.append(world.advance(2.0))
            except RuntimeError:  # the other thread looked first
                pass

    thread = threading.Thread(target=advance)
    thread.start()
    has_begun.wait()
    while thread.is_alive():
        for name in LOOKS.keys() - refused - {"remove_tets", "grasp"} or LOOKS.keys() - refused:
            try:
                LOOKS[name](world, hand)
            except RuntimeError as error:
                assert str(error) == "another thread is using this world"
                refused.add(name)
        assert world.precision == "double" and world.scene is scene  # these do not change
        assert "World" in repr(world) and "Grasp" in repr(hand)
    thread.join()
    assert reports[0].ok
    assert refused == LOOKS.keys()
    assert world.time > 2
