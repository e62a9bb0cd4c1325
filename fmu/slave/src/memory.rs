//! Memory that is asked for as a whole.
//!
//! Rust ends the process where a small allocation fails, and with it the host's simulation. So a slave first asks for
//! all that it may need, gives it back, and then builds: where there is not so much, the call is refused instead.

use std::hint::black_box;
use thiserror::Error;

/// There is not so much memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{bytes} bytes of memory are needed and not to be had: free some, or raise the process's limit")]
pub struct OutOfMemory {
    /// What was asked for.
    pub bytes: usize,
}

/// Whether so many bytes can be had now.
///
/// # Errors
/// [`OutOfMemory`].
pub fn ask(bytes: usize) -> Result<(), OutOfMemory> {
    let mut room: Vec<u8> = Vec::new();
    room.try_reserve_exact(bytes).map_err(|_| OutOfMemory { bytes })?;
    // else the compiler may leave out what nobody uses
    black_box(room.as_mut_ptr());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_has_is_refused_and_a_little_is_given() {
        assert_eq!(ask(1 << 20), Ok(()));
        assert_eq!(ask(usize::MAX / 2), Err(OutOfMemory { bytes: usize::MAX / 2 }));
    }
}
