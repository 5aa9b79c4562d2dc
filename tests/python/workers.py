"""What other processes do with what the tests send them."""

import lobe


def go_on(scene, checkpoint):
    """The displacements a tenth of a second after the checkpoint, and the regions of the scene."""
    world = lobe.World(scene)
    world.restore(checkpoint)
    assert world.advance(0.1).ok
    return world.snapshot().u, scene.regions.copy()


def go_on_from_file(scene, file):
    return go_on(scene, lobe.read_checkpoint(file))
