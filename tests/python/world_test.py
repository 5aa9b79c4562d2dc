import gc
import resource
import threading
import time

import conftest
import lobe
import numpy as np
import pytest


def test_a_beam_comes_to_rest_in_its_static_equilibrium(scene, mesh):
    world = lobe.World(scene)
    for _ in range(240):
        assert world.advance(1 / 60).ok
    exact = lobe.solve(scene)
    assert exact.converged and exact.residual < 1e-10
    assert lobe.compare(mesh, world.snapshot().u, exact.u).l2 < 1e-6
    assert exact.u[:, 2].min() < -0.01


def test_a_material_with_viscosity_relaxes(mesh, tip):
    def forces(**material):  # of the end that is pulled in one frame and stays there: after it, and at last
        materials = [dict(lame_lambda=2e4, lame_mu=1e4, density=1000, **material)]
        still = dict(conftest.BEAM, materials=materials, gravity=[0, 0, 0], time={"damping": 200, "precision": "double"})
        world = lobe.World(lobe.Scene(still, mesh))
        grasp = world.grasp(tip)
        world.advance(1 / 60)
        grasp.move_to(grasp.position + [0.002, 0, 0])
        found = []
        for frame in range(1, 91):
            assert world.advance(1 / 60).ok
            if frame in (7, 90):
                found.append(grasp.force[0])
        return np.array(found)

    ratio = forces(viscosity=[{"shear": 0.5, "bulk": 0.5, "time": 0.1}]) / forces()
    assert ratio == pytest.approx([1 + np.exp(-6.5 / 60 / 0.1), 1], rel=0.03)
    with pytest.raises(lobe.InputError) as caught:
        forces(viscosity=[{"shear": 0.6, "time": 0.1}, {"shear": 0.4, "time": 1}])
    assert caught.value.place == "/materials/0/viscosity"


def test_the_same_bits_on_one_and_two_threads(scene):
    one, two = lobe.World(scene, threads=1), lobe.World(scene, threads=2)
    for world in (one, two):
        for _ in range(5):
            world.advance(1 / 60)
    assert (one.snapshot().u == two.snapshot().u).all()


def test_precision_is_the_scenes_or_what_is_asked_for(scene):
    assert lobe.World(scene).precision == "double"
    world = lobe.World(scene, precision="single")
    assert world.snapshot().u.dtype == np.float32
    with pytest.raises(lobe.InputError, match="half"):
        lobe.World(scene, precision="half")


def test_a_snapshot_does_not_change_and_outlives_cuts_and_the_world(scene):
    world = lobe.World(scene)
    world.advance(0.1)
    moment = world.snapshot()
    u, triangles = moment.u, moment.surface.triangles
    assert np.shares_memory(u, moment.u)
    before, corners = u.copy(), triangles.copy()
    world.remove_tets(np.arange(30))
    world.advance(0.1)
    later = world.snapshot()
    assert later.surface.cut.any() and (later.surface.burnt == later.surface.cut).all()
    assert later.surface.revision > moment.surface.revision
    assert (u == before).all() and (triangles == corners).all()
    assert not np.shares_memory(u, later.u)
    del world, moment, later
    gc.collect()
    assert (u == before).all()
    with pytest.raises(ValueError):
        u[0, 0] = 1


def test_the_surface_is_closed_and_its_vertices_are_the_bodys(scene, mesh):
    world = lobe.World(scene)
    world.advance(0.05)
    moment = world.snapshot()
    surface = moment.surface
    a, b, c = (surface.x[surface.triangles[:, i]] for i in range(3))
    enclosed = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    x = mesh.points + moment.u
    t = x[mesh.tets]
    volume = np.linalg.det(t[:, 1:] - t[:, :1]).sum() / 6
    assert enclosed == pytest.approx(volume, rel=1e-12)
    assert (surface.x == x[surface.vertex]).all()


def test_snapshots_leave_nothing_behind(scene):
    world = lobe.World(scene)
    for _ in range(2000):
        world.snapshot().surface.x
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(20000):
        world.snapshot().surface.x
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4096  # [KiB]; one takes 20


def test_a_grasp_feels_what_it_holds(mesh, tip):
    still = dict(conftest.BEAM, gravity=[0, 0, 0])
    world = lobe.World(lobe.Scene(still, mesh))
    hand = world.grasp(tip)
    world.advance(0.01)
    assert (hand.vertices == tip).all()
    start = hand.position
    assert start == pytest.approx(mesh.points[tip].mean(axis=0), rel=1e-12)
    for i in range(200):
        hand.move_to(start + [0, 0, 0.005 * min(1, (i + 1) / 50)])
        assert world.advance(1 / 60).ok
    assert hand.position == pytest.approx(start + [0, 0, 0.005], rel=1e-12)
    reaction = world.forces()[tip].sum(axis=0)
    assert hand.force == pytest.approx(-reaction, rel=1e-6, abs=1e-9)
    assert hand.force[2] > 0.01
    (tool,) = world.snapshot().tools
    assert tool["type"] == "grasp" and (tool["force"] == -hand.force).all()
    hand.release()
    world.advance(0.01)
    assert world.snapshot().tools == []
    with pytest.raises(lobe.InputError, match="was let go already"):
        hand.move_to(start)


def test_a_turned_grasp_has_a_torque(mesh, tip):
    world = lobe.World(lobe.Scene(dict(conftest.BEAM, gravity=[0, 0, 0]), mesh))
    hand = world.grasp(tip)
    world.advance(0.01)
    centre = hand.position
    for i in range(120):
        angle = 0.3 * min(1, (i + 1) / 60)
        hand.move_to(centre, (np.sin(angle / 2), 0, 0, np.cos(angle / 2)))
        world.advance(1 / 60)
    assert hand.torque[0] > 10 * max(abs(hand.torque[1]), abs(hand.torque[2]))


def test_a_cautery_burns_what_it_touches(scene, mesh):
    world = lobe.World(scene)
    tool = world.cautery((0.05, 0.01, 0.05), radius=0.004)
    tool.move_to((0.05, 0.01, 0.01))
    assert world.advance(0.001).tets_removed == 0  # it is off
    tool.switch(True)
    removed = world.advance(0.001).tets_removed
    assert removed > 0 and world.tet_count == len(mesh.tets) - removed
    tool.release()


def test_a_scalpel_cuts_what_its_edge_moves_through(scene, mesh):
    world = lobe.World(scene)
    tool = world.scalpel((0.052, -0.01, 0.1), (0.052, 0.05, 0.1))
    tool.move_to((0.052, -0.01, 0.05))
    assert world.advance(0.001).cut_area == 0  # it does not cut yet
    tool.switch(True)
    area = copied = 0
    for i in range(60):
        tool.move_to((0.052, -0.01, 0.05 - 0.001 * (i + 1)))
        report = world.advance(0.001)
        assert report.tets_removed == 0
        area, copied = area + report.cut_area, copied + report.tets_copied
    size = mesh.points.max(axis=0) - mesh.points.min(axis=0)
    assert 0.9 < area / (size[1] * size[2]) < 1.2 and copied > 0
    assert world.tet_count == len(mesh.tets) + copied
    tool.release()


def test_forces_and_springs_hold_a_vertex_where_they_balance(mesh, tip):
    world = lobe.World(lobe.Scene(dict(conftest.BEAM, gravity=[0, 0, 0]), mesh))
    v = tip[:1]
    stiffness = 50.0
    point = mesh.points[v] + [[0, 0, 0.004]]
    world.set_springs(v, point, stiffness)
    for _ in range(300):
        world.advance(1 / 60)
    sprung = world.snapshot().u
    pull = stiffness * (point - mesh.points[v] - sprung[v])
    world.set_springs([], np.zeros((0, 3)), stiffness)
    world.set_forces(v, pull)
    for _ in range(300):
        world.advance(1 / 60)
    assert abs(world.snapshot().u - sprung).max() < 1e-6 * abs(sprung).max()


def test_a_restored_world_goes_on_with_the_same_bits(scene, tmp_path):
    world = lobe.World(scene)
    world.advance(0.05)
    kept = world.save()
    world.remove_tets([3, 4])
    world.advance(0.05)
    first = world.snapshot().u
    world.restore(kept)
    world.remove_tets([3, 4])
    world.advance(0.05)
    assert (world.snapshot().u == first).all()
    kept.save(tmp_path / "state")
    assert (tmp_path / "state").stat().st_size > 1000
    with pytest.raises(lobe.InputError):
        lobe.World(scene, precision="single").restore(kept)


def test_two_threads_cannot_use_one_world_and_others_run_meanwhile(scene):
    world = lobe.World(scene)
    refused, reports = [], []

    def advance():
        while not reports:
            try:
                reports.append(world.advance(2.0))
            except RuntimeError:  # the other thread looked first
                pass

    thread = threading.Thread(target=advance)
    thread.start()
    while thread.is_alive():
        try:
            world.snapshot()
        except RuntimeError as error:
            refused.append(str(error))
        time.sleep(0.001)
    thread.join()
    assert reports[0].ok
    assert reports[0].transitions.count == 0 and reports[0].transitions.total == 0
    assert refused and set(refused) == {"another thread is using this world"}
    assert world.advance(0.01).ok


@pytest.mark.parametrize(
    "call, place",
    [
        (lambda w: w.advance(-1), "advance"),
        (lambda w: w.grasp(), "grasp"),
        (lambda w: w.grasp([10**9]), "vertices"),
        (lambda w: w.grasp(np.ones(3, bool)), "vertices"),
        (lambda w: w.grasp([0.5]), "vertices"),
        (lambda w: w.grasp(near=(9, 9, 9), radius=0.1), "near"),
        (lambda w: w.grasp(near=(np.nan, 0, 0), radius=0.1), "near"),
        (lambda w: w.cautery((0, 0, 0), radius=-1), "radius"),
        (lambda w: w.scalpel((0, 0, 0), (0, 0, 0)), "scalpel"),
        (lambda w: w.remove_tets([-1]), "tets"),
        (lambda w: w.set_region([0], "soft"), "model"),
        (lambda w: w.set_forces([0], np.zeros((2, 3))), "forces"),
        (lambda w: w.set_springs([0], np.zeros((1, 3)), -1.0), ""),
    ],
)
def test_bad_calls_are_refused_and_change_nothing(scene, call, place):
    world = lobe.World(scene)
    before = world.snapshot().u
    with pytest.raises(lobe.InputError) as caught:
        call(world)
    assert place in caught.value.place or place in str(caught.value)
    assert (world.snapshot().u == before).all() and world.time == 0


def test_a_ligament_bears_the_beam_until_it_tears_and_an_event_says_where(scene):
    free, world = lobe.World(scene), lobe.World(scene)
    world.attach("ligament", [(0.095, 0.01, 0.01)], [(0.095, 0.01, 0.04)], stiffness=50, strength=0.05, to_world=True)
    events = []
    for _ in range(60):
        free.advance(1 / 60)
        events += world.advance(1 / 60).events
    (ligament,) = world.attachments
    assert [event.kind for event in events] == ["torn"] and ligament["torn"] == 1 and ligament["strands"] == 0
    assert events[0].text == 'attachment "ligament" has torn' and 0 < events[0].time < 1
    assert abs(events[0].place[0] - 0.095) < 0.01 and 0.01 < events[0].place[2] < 0.04
    assert ligament["released"] == pytest.approx(3 * 0.05**2 / 50 / 2, rel=1e-12)

    world = lobe.World(scene)
    world.attach("ligament", [(0.095, 0.01, 0.01)], [(0.095, 0.01, 0.04)], stiffness=50, to_world=True)
    for _ in range(60):
        assert not world.advance(1 / 60).events
    assert world.attachments[0]["tension"] > 0.05 and world.attachments[0]["ends"].shape == (2, 3)
    assert world.snapshot().u[:, 2].min() > free.snapshot().u[:, 2].min() / 2
    with pytest.raises(lobe.InputError, match="there is one of this name already"):
        world.attach("ligament", [(0.05, 0.01, 0.01)], [(0.05, 0.01, 0.04)], stiffness=50, to_world=True)
    with pytest.raises(lobe.InputError, match="outside of every tetrahedron"):
        world.attach("other", [(0.05, 0.01, 0.01)], [(0.05, 0.01, 0.04)], stiffness=50)
    world.detach("ligament")
    assert world.attachments[0]["strands"] == 0 and world.attachments[0]["cut"] == 1
