"""Makes the MDF files of this folder with asammdf (PyPI) 8: python make_mdf.py here. The signals are those of formats/main.rs."""

import numpy as np
from asammdf import MDF, Signal

COUNT = 60
index = np.arange(COUNT)
t = index / 128.0
q = (index * index % 31).astype(float)
qd = (index % 3) * 0.5
F = (index % 5) - 2.0


def signal(name, samples, unit="", times=t, conversion=None):
    return Signal(samples=samples, timestamps=times, name=name, unit=unit, conversion=conversion)


def save(mdf, name, compression):
    mdf.save(name, overwrite=True, compression=compression)


# One group; q counted in steps of 0.5 mm (a linear conversion), F in one byte.
mdf = MDF(version="4.10")
steps = signal("q", (q * 2).astype("int16"), "mm", conversion={"a": 0.5, "b": 0.0})
mdf.append([steps, signal("qd", qd.astype("float32"), "m/s"), signal("F", F.astype("int8"), "N")])
save(mdf, "one_group.mf4", 2)

# A group for each signal, on one clock.
mdf = MDF(version="4.20")
for name, values in (("q", q), ("qd", qd), ("F", F)):
    mdf.append([signal(name, values)])
save(mdf, "a_group_each.mf4", 0)

# Two clocks: a temperature every tenth sample.
mdf = MDF(version="4.10")
mdf.append([signal("q", q), signal("qd", qd), signal("F", F)], acq_name="axis")
mdf.append([signal("temperature", 20.0 + 0.0 * t[::10], times=t[::10])], acq_name="slow")
save(mdf, "two_clocks.mf4", 1)
