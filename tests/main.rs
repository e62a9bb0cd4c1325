//! The library and the command line from outside, in one program: linked once, and no test waits for those of another
//! file. What counts allocations, reads the sources or holds an FMU has a program of its own.
//!
//! `cargo test --release --test main timing::` runs those of one file.

mod at_the_limit;
#[cfg(feature = "pictures")]
mod command_line;
mod compare;
mod drift;
#[cfg(feature = "cli")]
mod dropbear;
#[cfg(feature = "cli")]
mod examples;
mod faults;
#[path = "../measure/figures/follow.rs"]
mod follow;
mod force_law;
#[cfg(feature = "formats")]
mod formats;
mod hidden;
#[cfg(feature = "cli")]
mod hidden_effects;
mod known_laws;
mod limits;
mod missing;
#[cfg(feature = "pictures")]
mod page;
mod publication;
#[cfg(feature = "cli")]
mod recordings;
mod recovery;
#[cfg(feature = "cli")]
mod shapes;
mod simulate;
mod timing;
mod uncertainty;
mod weak_form;
