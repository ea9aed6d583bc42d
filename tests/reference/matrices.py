"""Writes the small NumPy and SciPy files in tests/reference/matrices: python3 tests/reference/matrices.py

All but the noted ones hold the stiffness [[2, -1, 0], [-1, 2, -1], [0, -1, 1]] of a chain."""

from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sp

folder = Path(__file__).parent / "matrices"
chain = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])

np.save(folder / "c_f8.npy", chain)
np.save(folder / "fortran_f8.npy", np.asfortranarray(chain))
np.save(folder / "big_f8.npy", chain.astype(">f8"))
np.save(folder / "f4.npy", chain.astype("<f4"))
np.save(folder / "i8.npy", chain.astype("<i8"))
np.save(folder / "big_i2.npy", chain.astype(">i2"))
np.save(folder / "i1.npy", chain.astype("i1"))
np.save(folder / "upper.npy", np.triu(chain))
# Not symmetric: the order of the axes shows.
order = np.array([[1.0, 2.0], [3.0, 4.0]])
np.save(folder / "order_c.npy", order)
np.save(folder / "order_fortran.npy", np.asfortranarray(order))
np.save(folder / "vector.npy", np.array([1.0, 2.0, 3.0]))
# Refused.
np.save(folder / "complex.npy", chain.astype(complex))
np.save(folder / "text.npy", np.array(["a", "b"]))
np.save(folder / "cube.npy", np.zeros((2, 2, 2)))
np.save(folder / "wide.npy", np.zeros((2, 3)))

np.savez(folder / "two.npz", K=chain, M=np.eye(3))
np.savez_compressed(folder / "one.npz", K=chain)
sp.save_npz(folder / "csc.npz", sp.csc_matrix(chain))
sp.save_npz(folder / "csr.npz", sp.csr_array(chain), compressed=False)
sp.save_npz(folder / "coo.npz", sp.coo_matrix(chain))
sp.save_npz(folder / "csr_order.npz", sp.csr_matrix(order))
sp.save_npz(folder / "dia.npz", sp.dia_matrix(chain))
sp.save_npz(folder / "lower.npz", sp.tril(chain).tocsc())

# One dof, called a.
np.save(folder / "single.npy", np.eye(1))
np.savez(folder / "single.npz", K=np.eye(1))
scipy.io.mmwrite(folder / "single.mtx", sp.eye(1).tocoo())
(folder / "single.txt").write_text("# the only dof\na\n")

scipy.io.mmwrite(folder / "symmetric.mtx", sp.coo_matrix(chain), symmetry="symmetric")
scipy.io.mmwrite(folder / "general.mtx", sp.coo_matrix(chain), symmetry="general")
scipy.io.mmwrite(folder / "array.mtx", chain)
