//! The balance against linear algebra, symmetry and known nonlinear oscillators.
