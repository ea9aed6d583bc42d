//! Studies: many solutions of a scene, put side by side.
