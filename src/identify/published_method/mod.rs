//! The published method as published: `capture` a record, solve its `equations`, compare predictions; `procedure`
//! begins anew at each switch.

mod capture;
mod equations;
mod procedure;

pub use procedure::Publication;
