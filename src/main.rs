//! The `switchid` command line.
fn main() {}
