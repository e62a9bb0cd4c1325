//! Which call is allowed in which state of an instance (FMI 2.0.4, section 4.2.4).

use serde::{Deserialize, Serialize};

/// The state of an instance; `fmi2DoStep` always finishes, so that "step in progress" and "canceled" do not occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization,
    /// Ready for `fmi2DoStep`.
    Step,
    /// After `fmi2Terminate`.
    Terminated,
    /// After an internal failure.
    Failed,
}

/// A function, or a group that shares its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    /// `fmi2SetDebugLogging`.
    SetDebugLogging,
    /// `fmi2SetupExperiment`.
    SetupExperiment,
    /// `fmi2EnterInitializationMode`.
    EnterInitializationMode,
    /// `fmi2ExitInitializationMode`.
    ExitInitializationMode,
    /// `fmi2Terminate`.
    Terminate,
    /// `fmi2Reset`.
    Reset,
    /// `fmi2GetReal`, `Integer`, `Boolean`, `String`.
    Get,
    /// `fmi2SetReal`, `Integer`, `Boolean`, `String`; fixed parameters are refused in [`Phase::Step`].
    Set,
    /// `fmi2GetFMUstate`, `Set`, `Free`, `SerializedFMUstateSize`, `Serialize`, `DeSerialize`.
    State,
    /// `fmi2GetDirectionalDerivative`: not offered.
    GetDirectionalDerivative,
    /// `fmi2SetRealInputDerivatives`: allowed, but no variable supports it.
    SetRealInputDerivatives,
    /// `fmi2GetRealOutputDerivatives`: allowed, but no variable supports it.
    GetRealOutputDerivatives,
    /// `fmi2DoStep`.
    DoStep,
    /// `fmi2CancelStep`: no step is ever pending.
    CancelStep,
    /// `fmi2GetStatus`, `RealStatus`, `IntegerStatus`, `BooleanStatus`, `StringStatus`.
    GetStatus,
}

impl Call {
    /// The columns: instantiated, initialization, step, terminated, failed. Reading is allowed in "instantiated",
    /// more than the standard asks: some simulators read every variable as soon as there is an instance.
    #[rustfmt::skip]
    const fn row(self) -> [bool; 5] {
        const YES: bool = true;
        const NO: bool = false;
        match self {
            //                              inst. init. step  term. failed
            Call::SetDebugLogging          => [YES, YES, YES, YES, YES],
            Call::SetupExperiment          => [YES, NO,  NO,  NO,  NO ],
            Call::EnterInitializationMode  => [YES, NO,  NO,  NO,  NO ],
            Call::ExitInitializationMode   => [NO,  YES, NO,  NO,  NO ],
            Call::Terminate                => [NO,  NO,  YES, NO,  NO ],
            Call::Reset                    => [YES, YES, YES, YES, YES],
            Call::Get                      => [YES, YES, YES, YES, YES],
            Call::Set                      => [YES, YES, YES, NO,  NO ],
            Call::State                    => [YES, YES, YES, YES, YES],
            Call::GetDirectionalDerivative => [NO,  NO,  NO,  NO,  NO ],
            Call::SetRealInputDerivatives  => [YES, YES, YES, NO,  NO ],
            Call::GetRealOutputDerivatives => [NO,  NO,  YES, YES, NO ],
            Call::DoStep                   => [NO,  NO,  YES, NO,  NO ],
            Call::CancelStep               => [NO,  NO,  NO,  NO,  NO ],
            Call::GetStatus                => [NO,  NO,  YES, YES, YES],
        }
    }

    /// Whether the call is allowed in that state.
    pub const fn allowed(self, phase: Phase) -> bool {
        self.row()[phase as usize]
    }
}
