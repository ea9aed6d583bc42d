//! Exact orbits of smooth systems.
