"""Makes the MAT files of this folder: MATLAB's timetables, tables and timeseries, written by mat-io (PyPI) 1.0.2.

Usage: pip install mat-io==1.0.2, then python make.py in this folder. The signals are those of ../main.rs.
"""

import warnings

import numpy as np
import pandas as pd
from matio import save_to_mat
from matio.utils.matclass import MatlabOpaque

COUNT = 60
index = np.arange(COUNT)
t = index / 128.0
q = (index * index % 31).astype(float)
qd = (index % 3) * 0.5
F = (index % 5) - 2.0


def column(values):
    return np.asarray(values, dtype=float).reshape(-1, 1)


def opaque(classname, **properties):
    return MatlabOpaque(properties=properties, classname=classname)


def frame(times):
    return pd.DataFrame({"q": q, "qd": qd, "F": F}, index=pd.Index(times, name="Time"))


def structure(**fields):
    content = np.empty((1, 1), dtype=[(name, object) for name in fields])
    for name, value in fields.items():
        content[0, 0][name] = value
    return content


def cells(*texts):
    return np.array([np.array([text]) for text in texts], dtype=object).reshape(1, -1)


def by_rate():
    """A timetable of a sample rate, with units: its times are not stored."""
    data = np.empty((1, 3), dtype=object)
    for place, values in enumerate((q * 1e3, qd, F)):
        data[0, place] = column(values)
    start = opaque("duration", millis=np.array([[0.0]]), fmt=np.array(["s"]))
    step = opaque("duration", millis=np.array([[1e3 / 128.0]]), fmt=np.array(["s"]))
    times = structure(origin=start, specifiedAsRate=np.bool_(True), stepSize=step, sampleRate=np.float64(128.0))
    content = structure(
        data=data, dimNames=cells("Time", "Variables"), varNames=cells("q", "qd", "F"), numRows=np.float64(COUNT),
        numVars=np.float64(3), rowTimes=times, varUnits=cells("mm", "m/s", "N"), versionSavedFrom=np.float64(4),
        minCompatibleVersion=np.float64(2))
    return opaque("timetable", any=content)


def series(name, values, times=None):
    """As `timeseries` keeps them: uniform times are in its TimeInfo alone."""
    uniform = times is None
    info = opaque(
        "tsdata.timemetadata", Units=np.array(["seconds"]), Start_=np.float64(0.0),
        End_=np.float64(t[-1]), Increment_=np.float64(1 / 128.0 if uniform else np.nan), Length_=np.float64(COUNT))
    stored = np.empty((0, 0)) if uniform else column(times)
    return opaque("timeseries", Name_=np.array([name]), Data_=column(values), Time_=stored, TimeInfo_=info)


def save(name, version, **variables):
    save_to_mat(name + {"v7": "_v7", "v7.3": "_v73"}[version] + ".mat", variables, version=version)


warnings.simplefilter("ignore")
for version in ("v7", "v7.3"):
    save("durations", version, run=frame(pd.to_timedelta((t * 1e9).astype("int64"), unit="ns")))
    save("dates", version, run=frame(np.datetime64("2024-05-01T12:00:00", "ns") + (t * 1e9).astype("int64")))
    save("rate", version, run=by_rate())
    save("table", version, run=pd.DataFrame({"time": t, "q": q, "qd": qd, "F": F}))
    save("uniform", version, q=series("q", q), qd=series("qd", qd), F=series("F", F))
    save("stamped", version, q=series("q", q, t), qd=series("qd", qd, t), F=series("F", F, t))
