//! `stickslip report` from outside.
