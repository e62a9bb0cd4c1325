//! The binary as a user meets it: bad input is refused with its place, good input gives one JSON document.

mod bad_input;
mod bench;
mod compare;
mod diagnose;
mod fmu;
mod force_law;
mod good_input;
mod habits;
mod known_laws;
mod limits;
mod looked;
mod missing_readings;
mod own_effects;
mod sensors;
mod units;
mod voice;
