//! The `stickslip` command line.
fn main() {}
