"""lobe_c.h by ctypes, as a caller without a C compiler: structs written down by hand. Arguments: liblobe_c.so, data/."""

import ctypes
import os
import sys
import tempfile

lobe = ctypes.CDLL(sys.argv[1])


class Surface(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("vertices", ctypes.c_uint32), ("triangles", ctypes.c_uint32),
                ("frame", ctypes.c_uint64), ("topology", ctypes.c_uint64), ("time", ctypes.c_double),
                ("position", ctypes.POINTER(ctypes.c_float)), ("normal", ctypes.POINTER(ctypes.c_float)),
                ("index", ctypes.POINTER(ctypes.c_uint32)), ("region", ctypes.POINTER(ctypes.c_uint8)),
                ("cut", ctypes.POINTER(ctypes.c_uint8)), ("owner", ctypes.c_void_p)]


def positions(session):
    surface = Surface(size=ctypes.sizeof(Surface))
    assert lobe.lobe_surface_acquire(session, ctypes.byref(surface)) == 0
    copy = surface.position[: 3 * surface.vertices]
    lobe.lobe_surface_release(session, ctypes.byref(surface))
    return copy


lobe.lobe_last_error.restype = ctypes.c_char_p
session = ctypes.c_void_p()
assert lobe.lobe_open(b"nothing.json", None, ctypes.byref(session)) == 1
assert b"nothing.json" in lobe.lobe_last_error()
scene = (sys.argv[2] + "/scenes/liver_hands.json").encode()
assert lobe.lobe_open(scene, None, ctypes.byref(session)) == 0, lobe.lobe_last_error()
assert lobe.lobe_advance(session, 3) == 0
surface = Surface(size=ctypes.sizeof(Surface))
assert lobe.lobe_surface_acquire(session, ctypes.byref(surface)) == 0
corners = surface.index[: 3 * surface.triangles]
assert len(set(corners)) == surface.vertices and max(corners) == surface.vertices - 1
first = surface.position[: 3 * surface.vertices]
lobe.lobe_surface_release(session, ctypes.byref(surface))
assert not surface.position

with tempfile.TemporaryDirectory() as folder:
    file = os.path.join(folder, "saved.lobe").encode()
    assert lobe.lobe_save(session, file) == 0, lobe.lobe_last_error()
    point, pose = (ctypes.c_double * 3)(0.082, -0.045, 0.035), (ctypes.c_double * 7)(0.082, -0.045, 0.045, 0, 0, 0, 1)
    assert lobe.lobe_grasp(session, 1, point, ctypes.c_double(0.02)) == 0
    assert lobe.lobe_move(session, 1, pose) == 0 and lobe.lobe_advance(session, 20) == 0
    assert positions(session) != first
    assert lobe.lobe_restore(session, file) == 0, lobe.lobe_last_error()
    assert positions(session) == first
    assert lobe.lobe_restore(session, file + b"?") == 1 and b"saved.lobe?" in lobe.lobe_last_error()
lobe.lobe_close(session)
