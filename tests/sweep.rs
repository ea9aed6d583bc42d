//! Sweeps: independent of threads, units, neighbours; nothing allocated on the way.
