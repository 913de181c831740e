"""The servo loop of capi.c through the shared library, with nothing but ctypes: any language that loads a library can do the same.

python3 shared_library.py libstribeck.so.0.1
"""
import ctypes as c
import math
import sys

if len(sys.argv) != 2:
    sys.exit(__doc__)
stribeck = c.CDLL(sys.argv[1])
stribeck.stribeck_version.restype = stribeck.stribeck_controller_problem.restype = c.c_char_p
stribeck.stribeck_controller_size.restype = stribeck.stribeck_alignment.restype = c.c_size_t
stribeck.stribeck_controller_init.restype = c.c_void_p


class Input(c.Structure):  # stribeck_axis_input
    _fields_ = [(name, c.c_double) for name in ("position", "velocity", "acceleration", "measured")]


if stribeck.stribeck_abi() != 1:
    sys.exit("this program was written for version 1 of the interface")
size, alignment = stribeck.stribeck_controller_size(1), stribeck.stribeck_alignment()
memory = c.create_string_buffer(size + alignment)
address = c.addressof(memory) + -c.addressof(memory) % alignment
controller = c.c_void_p(stribeck.stribeck_controller_init(c.c_void_p(address), c.c_size_t(size), 1))

numbers = {"mass": 800, "omega": 60, "force_limit": 250, "friction.conventional.alpha0": 15, "friction.conventional.alpha2": 3e3}
words = {"friction.steady": "conventional", "feedforward": "steady", "observer": "disturbance"}
for name, word in words.items():
    if stribeck.stribeck_controller_choose(controller, 0, name.encode(), word.encode()) != 0:
        sys.exit(stribeck.stribeck_controller_problem(controller).decode())
for name, value in numbers.items():
    if stribeck.stribeck_controller_set(controller, 0, name.encode(), c.c_double(value)) != 0:
        sys.exit(stribeck.stribeck_controller_problem(controller).decode())
period = 1e-3
if stribeck.stribeck_controller_configure(controller, c.c_double(period)) != 0:
    sys.exit(stribeck.stribeck_controller_problem(controller).decode())

x = v = error = 0.0
force = c.c_double()
for k in range(2000):
    w, t = 2.0, k * period
    now = Input(10e-3 * math.sin(w * t), 10e-3 * w * math.cos(w * t), -10e-3 * w * w * math.sin(w * t), x)
    error = now.measured - now.position
    if stribeck.stribeck_controller_step(controller, c.byref(now), c.byref(force)) != 0:
        sys.exit("the controller refused a sample")
    v += period * (force.value - 14.0 * math.tanh(v / 1e-4) - 3.2e3 * v) / 820.0
    x += period * v
print(f"stribeck {stribeck.stribeck_version().decode()}: tracking error after 2 s: {abs(error) * 1e6:.4f} um")
