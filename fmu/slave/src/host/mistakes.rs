//! Calls that no master should make, for the fuzzer.

use super::Instance;
use crate::ctypes::{OK, Real, Status, StatusKind};
use std::ptr::{null, null_mut};

/// A call without sense.
#[derive(Clone, Copy, Debug)]
pub enum Mistake {
    /// `fmi2GetReal` of three values into nothing.
    NullArray,
    /// `fmi2SetString` of a null pointer.
    NullText(u32),
    /// `fmi2GetDirectionalDerivative` of any two variables.
    Derivative([u32; 2], Real),
    /// `fmi2GetStatus` of that kind.
    Status(StatusKind),
    /// `fmi2SetRealInputDerivatives`.
    InputDerivative(u32),
    /// `fmi2CancelStep`.
    Cancel,
}

impl Instance {
    /// Makes the mistake.
    pub fn mistake(&self, mistake: Mistake) -> Status {
        let (mut real, mut status) = (0.0, OK);
        // SAFETY: the component is alive; null pointers are what is tried, all others are as long as said and outlive
        // the call.
        self.call(|f, c| unsafe {
            match mistake {
                Mistake::NullArray => (f.get_real)(c, null(), 3, null_mut()),
                Mistake::NullText(reference) => (f.set_string)(c, &reference, 1, &null()),
                Mistake::Derivative([unknown, known], seed) => {
                    (f.directional_derivative)(c, &unknown, 1, &known, 1, &seed, &mut real)
                }
                Mistake::Status(kind) => (f.get_status)(c, kind, &mut status),
                Mistake::InputDerivative(reference) => (f.input_derivatives)(c, &reference, 1, &1, &1.0),
                Mistake::Cancel => (f.cancel_step)(c),
            }
        })
    }
}
