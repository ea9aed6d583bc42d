//! What exact orbits refuse, and how they say it.
