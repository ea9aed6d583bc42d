"""What all scripts here share: a request is read, an answer is written, both JSON.

A request has a scene with one contact between its first dof and the ground and a force in phase on its last dof, and
cases. An answer repeats the cases with what they cost and the one-sided spectra `[k, re, im]` of every dof.
"""

import importlib.metadata
import json
import platform
import statistics
import sys
import time


def read():
    with open(sys.argv[1]) as file:
        return json.load(file)


def write(packages, cases):
    versions = {"Python": platform.python_version()}
    versions |= {name: importlib.metadata.version(name) for name in packages}
    with open(sys.argv[2], "w") as file:
        json.dump({"versions": versions, "cases": cases}, file)


def repeat(action, case):
    """A warm-up, then the median of the repeats in seconds, with the last result; `action` returns time and result."""
    seconds, result = action()
    repeats = case["repeats"]
    if repeats == 0:
        return seconds, result
    times = []
    for _ in range(repeats):
        seconds, result = action()
        times.append(seconds)
    return statistics.median(times), result


def clock():
    return time.perf_counter()


def point(frequency, spectra):
    """An entry of an answer; `spectra` is None where there is no solution."""
    entry = {"frequency": frequency, "solved": spectra is not None, "displacement": []}
    if spectra is not None:
        entry["displacement"] = [
            [[int(k), float(value.real), float(value.imag)] for k, value in spectrum] for spectrum in spectra
        ]
    return entry
