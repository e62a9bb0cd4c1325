//! What any method could reach: against closed forms, differences of motions, and figures known from a prototype.

mod bound;
mod detection;
mod friction;
mod record;
mod rules;
