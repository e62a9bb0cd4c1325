"""Makes recording_v73.mat as MATLAB 7.3 would save it: HDF5 behind a header of 512 bytes. Needs h5py and numpy.

    python tests/data/make_recording_v73.py tests/data/recording_v73.mat
"""

import sys

import h5py
import numpy

COUNT = 60
INDEX = numpy.arange(COUNT)


def save(group, name, values, matlab_class, **storage):
    dataset = group.create_dataset(name, data=values, **storage)
    dataset.attrs["MATLAB_class"] = numpy.bytes_(matlab_class)
    return dataset


def column(values):
    return values.reshape(1, COUNT)


with h5py.File(sys.argv[1], "w", userblock_size=512, libver=("earliest", "v108")) as file:
    packed = {"compression": "gzip", "shuffle": True}
    save(file, "time", column(INDEX / 128.0), "double", **packed)
    save(file, "position_mm", INDEX.reshape(COUNT, 1) ** 2 % 31.0, "double")
    save(file, "speed", column((INDEX % 3 * 0.5).astype(numpy.float32)), "single")
    save(file, "F", column((INDEX % 5 - 2).astype(numpy.int16)), "int16", **packed)
    save(file, "note", numpy.frombuffer(b"r\0u\0n\0", dtype=numpy.uint16).reshape(3, 1), "char")
    save(file, "grid", numpy.zeros((3, 4)), "double")
    wave = numpy.zeros((1, COUNT), dtype=[("real", "f8"), ("imag", "f8")])
    save(file, "wave", wave, "double")
    save(file, "none", numpy.zeros(2, dtype=numpy.uint64), "double").attrs["MATLAB_empty"] = numpy.uint8(1)
    run = file.create_group("run")
    run.attrs["MATLAB_class"] = numpy.bytes_("struct")
    save(run, "qd", column(INDEX * 0.25), "double")

with open(sys.argv[1], "r+b") as file:
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Jan  1 00:00:00 2026 HDF5 schema 1.00 ."
    file.write(text.ljust(116) + bytes(8) + b"\x00\x02IM")
