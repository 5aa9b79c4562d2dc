"""Several environments at once."""

import multiprocessing
from concurrent.futures import ThreadPoolExecutor

import numpy as np


class _Worker:
    """An environment that begins anew in the step after an episode has ended, as Gymnasium's vectors do."""

    def __init__(self, make):
        self.environment = make()
        self._is_over = False

    def reset(self, seed):
        self._is_over = False
        return self.environment.reset(seed=seed)

    def step(self, action):
        if self._is_over:
            observation, info = self.reset(None)
            return observation, 0.0, False, False, info
        observation, reward, terminated, truncated, info = self.environment.step(action)
        self._is_over = terminated or truncated
        return observation, reward, terminated, truncated, info


def _serve(make, pipe):
    worker = _Worker(make)
    pipe.send((worker.environment.action_space, worker.environment.observation_space))
    while True:
        name, argument = pipe.recv()
        if name == "close":
            return
        try:
            pipe.send((True, getattr(worker, name)(argument)))
        except Exception as error:  # goes to whoever asked
            pipe.send((False, error))


class _Threads:
    """Workers in threads of this process. Worlds compute at the same time: they release Python's lock."""

    def __init__(self, makers):
        self._workers = [_Worker(make) for make in makers]
        self._pool = ThreadPoolExecutor(len(makers))
        environment = self._workers[0].environment
        self.spaces = environment.action_space, environment.observation_space

    def ask(self, name, arguments):
        calls = [self._pool.submit(getattr(worker, name), argument)
                 for worker, argument in zip(self._workers, arguments)]
        return [call.result() for call in calls]

    def close(self):
        self._pool.shutdown()


class _Processes:
    """Workers in processes of their own."""

    def __init__(self, makers):
        context = multiprocessing.get_context("spawn")
        self._pipes, self._processes = [], []
        for make in makers:
            here, there = context.Pipe()
            process = context.Process(target=_serve, args=(make, there), daemon=True)
            process.start()
            there.close()
            self._pipes.append(here)
            self._processes.append(process)
        try:
            self.spaces = [pipe.recv() for pipe in self._pipes][0]
        except EOFError:
            raise RuntimeError("a process could not make its environment: it says why above") from None

    def ask(self, name, arguments):
        for pipe, argument in zip(self._pipes, arguments):
            pipe.send((name, argument))
        answers = [pipe.recv() for pipe in self._pipes]
        for is_done, answer in answers:
            if not is_done:
                raise answer
        return [answer for _, answer in answers]

    def close(self):
        for pipe in self._pipes:
            pipe.send(("close", None))
        for process in self._processes:
            process.join()


class Vector:
    """Several environments that take a step at once, by the API of gymnasium.vector.

    makers: functions that make an environment each; with processes they must pickle (a class, or
    functools.partial of one). An environment whose episode has ended begins anew in its next step, which
    leaves out the action and has reward 0.
    """

    def __init__(self, makers, *, workers="threads"):
        kinds = {"threads": _Threads, "processes": _Processes}
        makers = list(makers)
        if workers not in kinds:
            raise ValueError(f'workers must be "threads" or "processes", not {workers!r}')
        if not makers:
            raise ValueError("a vector needs at least one environment")
        self.num_envs = len(makers)
        self._workers = kinds[workers](makers)
        self.single_action_space, self.single_observation_space = self._workers.spaces
        self._is_closed = False

    def reset(self, *, seed=None, options=None):
        """Begins all: number i with seed + i. Returns (observations, infos)."""
        seeds = [None if seed is None else seed + i for i in range(self.num_envs)]
        observations, infos = zip(*self._workers.ask("reset", seeds))
        return np.stack(observations), _merged(infos)

    def step(self, actions):
        """Returns arrays (observations, rewards, terminated, truncated) with a row each, and infos."""
        actions = np.asarray(actions)
        if len(actions) != self.num_envs:
            raise ValueError(f"{len(actions)} actions for {self.num_envs} environments")
        observations, rewards, terminated, truncated, infos = zip(*self._workers.ask("step", actions))
        return (np.stack(observations), np.array(rewards), np.array(terminated), np.array(truncated),
                _merged(infos))

    def close(self):
        """Ends its threads or processes."""
        if not self._is_closed:
            self._is_closed = True
            self._workers.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def _merged(infos):
    """{key: array with a row per environment}."""
    return {key: np.array([info[key] for info in infos]) for key in infos[0]}
