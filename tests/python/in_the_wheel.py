"""What an installed mbk does first: reads arrays, measures them, simulates, writes and reads a file. Prints its place."""

import importlib.metadata

import mbk
import numpy as np

t = np.arange(20000) / 1000
x = 0.02 * np.sin(9 * t) + 0.01 * np.sin(23 * t)
v, a = 0.18 * np.cos(9 * t) + 0.23 * np.cos(23 * t), -1.62 * np.sin(9 * t) - 5.29 * np.sin(23 * t)
found = mbk.measure(mbk.Recording(time=t, x=x, F=-(0.01 * a + 0.1 * v + 5 * x)), cutoff="none")
assert abs(found.model.K[0, 0] - 5) < 0.05, found.model.K
mbk.simulate("free_motion").save("free.h5")
assert mbk.read("free.h5").rate_hz == 1000
assert importlib.metadata.version("mbk") == mbk.__version__
print(mbk.__version__, mbk.__file__)
