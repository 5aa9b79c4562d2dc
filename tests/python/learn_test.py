"""Environments for programs that learn: their interface, and a scripted policy that solves each task."""

import functools
import subprocess
import sys

import numpy as np
import pytest
from lobe import learn
from lobe.learn import cutting, palpation

TASKS = [learn.Retraction, learn.Palpation, learn.Cutting]


def play(environment, seed, policy):
    """Steps with the actions that policy(environment, [observation]) yields: (rewards, terminated, info)."""
    observation, info = environment.reset(seed=seed)
    box = [observation]
    rewards = []
    for action in policy(environment, box):
        box[0], reward, terminated, truncated, info = environment.step(action)
        rewards.append(reward)
        if terminated or truncated:
            return rewards, terminated, info
    return rewards, False, info


def way(environment, target, fastest):
    """Velocities that lead a tool to a place."""
    while np.linalg.norm(target - environment.place) > 1e-5:
        velocity = (target - environment.place) / environment.frame
        yield velocity * min(1.0, fastest / np.linalg.norm(velocity))


def pull_aside(environment, box):
    while True:
        yield np.array([-0.1, 0, 0.05])


def touch_everywhere(environment, box):
    touching, felt = palpation.HEIGHT + palpation.TIP, []
    above, pressed = touching + 0.002, touching - 0.003
    for place in palpation.PLACES:
        for height in (above, pressed, pressed, above):
            for velocity in way(environment, np.array([*place, height]), 0.19):
                yield np.append(velocity, -1)
            if height == pressed:
                yield np.array([0, 0, 0, -1])
                force = box[0][5]
        felt.append(force)
    stiffest = palpation.PLACES[int(np.argmax(felt))]
    for velocity in way(environment, np.array([*stiffest, above]), 0.19):
        yield np.append(velocity, -1)
    yield np.array([0, 0, 0, 1])


def cut_straight(environment, box):
    start, end = box[0][3:5], box[0][5:7]
    depth = cutting.HEIGHT - cutting.DEPTH - 0.001
    beyond = end + 0.01 * (end - start) / np.linalg.norm(end - start)
    for target in ([*start, 0.03], [*start, depth], [*beyond, depth]):
        yield from way(environment, np.array(target), 0.1)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_flap_that_is_pulled_aside_shows_what_it_hid(seed):
    rewards, terminated, _ = play(learn.Retraction(), seed, pull_aside)
    assert terminated and len(rewards) < 60
    assert sum(rewards) == pytest.approx(0.96, abs=0.05)


def test_who_pulls_too_hard_loses_reward():
    gentle, rough = learn.Retraction(), learn.Retraction(gentle=0.0)
    assert sum(play(rough, 1, pull_aside)[0]) < sum(play(gentle, 1, pull_aside)[0]) - 0.1


def test_a_lump_is_found_by_touch():
    environment = learn.Palpation()
    places = set()
    for seed in range(3):
        rewards, terminated, info = play(environment, seed, touch_everywhere)
        assert terminated and rewards[-1] == 1 and not any(rewards[:-1])
        places.add(tuple(info["place"]))
    assert len(places) > 1
    environment.reset(seed=1)
    _, reward, terminated, _, info = environment.step([0, 0, 0, 1])
    is_near = np.linalg.norm(environment.place[:2] - info["place"]) < 0.008
    assert terminated and reward == (1 if is_near else -1)


def test_a_line_is_cut_and_what_is_beside_it_is_told():
    environment = learn.Cutting()
    before = environment.world.tet_count
    for seed in range(3):
        rewards, terminated, info = play(environment, seed, cut_straight)
        assert terminated and 0.95 <= sum(rewards) <= 1 + 1e-12 and info["beside"] == 0
    assert environment.world.tet_count > before
    environment.reset(seed=1)
    assert environment.world.tet_count == before

    def cut_across(environment, box):
        for target in ([0.03, -0.01, 0.03], [0.03, -0.01, 0.006], [0.03, 0.05, 0.006]):
            yield from way(environment, np.array(target), 0.1)

    rewards, terminated, info = play(environment, 1, cut_across)
    assert not terminated and sum(rewards) < -1 and 1e-4 < info["beside"] < 0.04 * 0.006


@pytest.mark.parametrize("task", TASKS)
def test_it_has_the_interface_of_gymnasium(task):
    environment = task()
    observation, info = environment.reset(seed=7)
    assert observation in environment.observation_space and observation.dtype == np.float32
    assert set(info) >= {"time"} and environment.unwrapped is environment
    environment.action_space.seed(3)
    answers = []
    for _ in range(2):
        environment.action_space.seed(3)
        episode = [environment.reset(seed=7)[0]]
        for _ in range(5):
            action = environment.action_space.sample()
            assert action in environment.action_space
            observation, reward, terminated, truncated, info = environment.step(action)
            assert isinstance(reward, float) and type(terminated) is bool and type(truncated) is bool
            episode.append(observation)
            if terminated or truncated:
                break
        answers.append(np.stack(episode))
    assert (answers[0] == answers[1]).all()  # the same seed and actions: the same bits


def test_an_episode_is_truncated_and_must_be_begun():
    environment = learn.Retraction(longest=2)
    with pytest.raises(ValueError, match=r"call reset\(\)"):
        environment.step([0, 0, 0])
    environment.reset()
    assert environment.step([0, 0, 0])[2:4] == (False, False)
    assert environment.step([0, 0, 0])[2:4] == (False, True)
    with pytest.raises(ValueError, match="is over"):
        environment.step([0, 0, 0])
    environment.reset()
    for wrong in ([0, 0], [[0, 0, 0]], [0, 0, float("nan")]):
        with pytest.raises(ValueError, match="an action is"):
            environment.step(wrong)
    for wrong in ({"frame": 0}, {"longest": 0}):
        with pytest.raises(ValueError, match="above 0"):
            learn.Retraction(**wrong)


def test_a_reward_of_the_users_own():
    environment = learn.Retraction(reward=lambda own, report: own.steps + report.steps / 1e6)
    environment.reset()
    assert environment.step([0, 0, 0])[1] == pytest.approx(1, abs=1e-3)
    assert environment.step([0, 0, 0])[1] == pytest.approx(2, abs=1e-3)


@pytest.mark.parametrize("workers", ["threads", "processes"])
def test_a_vector_gives_what_its_environments_give_alone(workers):
    make = functools.partial(learn.Retraction, longest=3)
    actions = np.array([[-0.1, 0, 0.05], [0, 0.1, 0]])
    alone = [make() for _ in actions]
    expected = [one.reset(seed=5 + i)[0] for i, one in enumerate(alone)]
    with learn.Vector([make, make], workers=workers) as vector:
        observations, infos = vector.reset(seed=5)
        assert (observations == np.stack(expected)).all() and infos["time"].shape == (2,)
        for step in range(3):
            observations, rewards, terminated, truncated, infos = vector.step(actions)
            for i, one in enumerate(alone):
                observation, reward, *over, _ = one.step(actions[i])
                assert (observations[i] == observation).all() and rewards[i] == reward
                assert [terminated[i], truncated[i]] == over == [False, step == 2]
        observations, rewards, terminated, truncated, _ = vector.step(actions)  # begin anew
        assert not rewards.any() and not terminated.any() and not truncated.any()
        for i, one in enumerate(alone):
            assert (observations[i] == one.reset()[0]).all()
        with pytest.raises(ValueError, match="3 actions for 2"):
            vector.step(np.zeros((3, 3)))
        with pytest.raises(ValueError, match="an action is"):
            vector.step(np.zeros((2, 2)))


def test_a_vector_of_nothing_is_refused():
    with pytest.raises(ValueError, match="at least one"):
        learn.Vector([])
    with pytest.raises(ValueError, match="must be"):
        learn.Vector([learn.Retraction], workers="fibres")


def test_a_box_is_what_gymnasium_says():
    box = learn.Box(np.array([-1, 0]), np.array([1, np.inf]), seed=1)
    assert box.shape == (2,) and np.float32([0, 3]) in box and np.float32([0, -1]) not in box
    assert np.float32([0]) not in box
    drawn = np.stack([box.sample() for _ in range(100)])
    assert all(x in box for x in drawn) and drawn[:, 0].std() > 0.3


def test_what_it_costs_is_printed():
    command = [sys.executable, "-m", "lobe.learn", "0.05"]
    out = subprocess.run(command, capture_output=True, text=True, check=True)
    rows = [line.split() for line in out.stdout.splitlines()]
    assert [row[0] for row in rows[1:5]] == ["Block", "Retraction", "Palpation", "Cutting"] and len(rows) == 7
    assert rows[1][1] == "2058" and all(float(number) > 0 for row in rows[1:5] for number in row[1:])
