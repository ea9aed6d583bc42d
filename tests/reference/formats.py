"""Writes the small files of tests/reference/formats, which tests read.

Written by NumPy 2.4.6, SciPy 1.17.1 and pyuff 2.5.8:

    python tests/reference/formats.py

Every file but the refused ones holds the same motion: 3 cycles of d = 8 cos(t) um with 16 samples a cycle, and f = 12 cos(t + 1) N,
whole numbers rounded to a quarter, so that every type of number holds them exactly.
"""

import os
import struct
from pathlib import Path

import numpy as np
import pyuff
import scipy.io

folder = Path(__file__).parent / "formats"
folder.mkdir(exist_ok=True)

phase = np.arange(49) * 2 * np.pi / 16
d = np.round(8 * np.cos(phase) * 4) / 4
f = np.round(12 * np.cos(phase + 1) * 4) / 4
t = np.arange(49) / 64
both, all3 = np.column_stack([d, f]), np.column_stack([t, d, f])

# NumPy.
np.save(folder / "c_f8.npy", both)
np.save(folder / "fortran_f4.npy", np.asfortranarray(all3.astype("<f4")))
np.save(folder / "big_f8.npy", both.astype(">f8"))
np.save(folder / "quarters_i2.npy", (4 * both).astype("<i2"))
np.save(folder / "wide.npy", both.T)
np.save(folder / "vector.npy", d)
np.save(folder / "pickled.npy", np.array([d, f], dtype=object), allow_pickle=True)
fields = np.zeros(49, dtype=[("time [s]", "<f8"), ("displacement [um]", "<f4"), ("force [N]", "<f8")])
fields["time [s]"], fields["displacement [um]"], fields["force [N]"] = t, d, f
np.save(folder / "structured.npy", fields)
np.savez(folder / "named.npz", **{"time [s]": t, "displacement [um]": d, "force [N]": f})
np.savez_compressed(folder / "matrix.npz", rig=all3, rate=np.array(64.0), remark=np.array("rig 2"))
np.savez(folder / "ambiguous.npz", d=d, x=2 * d, f=f)

# MATLAB.
scipy.io.savemat(folder / "v5.mat", {"disp": d, "force": f, "time": t, "remark": "rig 2"})
scipy.io.savemat(folder / "compressed.mat", {"disp": d[:, None], "force": f[:, None], "cells": np.array([d, f], dtype=object)}, do_compression=True)
scipy.io.savemat(folder / "matrix.mat", {"data": all3}, do_compression=True)
scipy.io.savemat(folder / "types.mat", {"d": d.astype("f4"), "f": (4 * f).astype("i2")})
scipy.io.savemat(folder / "struct.mat", {"rig": {"disp": d, "force": f, "fs": 64.0}, "version": 3})
scipy.io.savemat(folder / "complex.mat", {"disp": d + 1j * d, "force": f})
scipy.io.savemat(folder / "v4.mat", {"disp": d, "force": f}, format="4")


def big_endian(**arrays):
    """A file as a machine with the other order of bytes writes it; SciPy writes only its own order, but reads both."""

    def element(kind, data):
        return struct.pack(">II", kind, len(data)) + data + bytes(-len(data) % 8)

    out = b"MATLAB 5.0 MAT-file, big endian".ljust(124) + b"\x01\x00MI"
    for name, values in arrays.items():
        parts = element(6, struct.pack(">II", 6, 0)) + element(5, struct.pack(">ii", len(values), 1))
        parts += element(1, name.encode()) + element(9, values.astype(">f8").tobytes())
        out += struct.pack(">II", 14, len(parts)) + parts
    return out


(folder / "big.mat").write_bytes(big_endian(d=d, force=f))
read = scipy.io.loadmat(folder / "big.mat")
assert (read["d"][:, 0] == d).all() and (read["force"][:, 0] == f).all()
# Only the header: what MATLAB writes with -v7.3.
text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 00:00:00 2024 HDF5 schema 1.00 ."
header = text.ljust(116) + bytes(8) + b"\x00\x02IM"
(folder / "v73.mat").write_bytes(header.ljust(512, b"\0") + b"\x89HDF\r\n\x1a\n" + bytes(88))


# Universal files.
def dataset(values, kind, label, unit, node, **more):
    made = pyuff.prepare_58(
        binary=0, id1=f"{label} of the rig", func_type=1, rsp_node=node, rsp_dir=1, ref_node=0, ref_dir=0,
        ordinate_spec_data_type=kind, ordinate_axis_units_lab=unit,
        abscissa_spec_data_type=17, abscissa_axis_units_lab="s",
        orddenom_spec_data_type=0, z_axis_spec_data_type=0, data=values, x=t, **more,
    )
    return {**made, "ordinate_axis_lab": label, "abscissa_axis_lab": "Time"}


def universal(name, sets, force_double=True):
    path = folder / name
    if path.exists():
        os.remove(path)
    pyuff.UFF(str(path)).write_sets(sets, mode="add", force_double=force_double)


even = {"abscissa_spacing": 1, "abscissa_min": 0.0, "abscissa_inc": 1 / 64}
uneven = {"abscissa_spacing": 0, "abscissa_min": 0.0, "abscissa_inc": 0.0}
universal("even_double.uff", [dataset(d, 8, "Displacement", "um", 12, ord_data_type=4, **even),
                              dataset(f, 13, "Force", "N", 12, ord_data_type=4, **even)])
universal("uneven_double.uff", [dataset(f, 0, "load cell", "N", 7, ord_data_type=4, **uneven),
                                dataset(d, 0, "slider", "um", 3, ord_data_type=4, **uneven)])
universal("even_single.uff", [dataset(d, 8, "NONE", "NONE", 12, ord_data_type=2, **even),
                              dataset(f, 9, "NONE", "NONE", 13, ord_data_type=2, **even)], force_double=False)
binary = [dataset(d, 8, "Displacement", "um", 12, ord_data_type=4, **even)]
binary[0]["binary"] = 1
universal("binary.uff", binary)
