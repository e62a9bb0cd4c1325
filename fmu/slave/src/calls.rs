//! Which call is allowed in which state of an instance (FMI 2.0.4, sections 3.2.3 and 4.2.4).

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
    /// Model exchange at an event, also just after initialization.
    Event,
    /// Model exchange while the host integrates.
    Continuous,
    /// After `fmi2Terminate`.
    Terminated,
    /// After an internal failure.
    Failed,
}

impl Phase {
    /// Whether it is initialised and neither ended nor broken.
    pub const fn runs(self) -> bool {
        matches!(self, Phase::Step | Phase::Event | Phase::Continuous)
    }
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
    /// `fmi2SetReal`, `Integer`, `Boolean`, `String`; fixed parameters are refused where it runs.
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
    /// `fmi2EnterEventMode`.
    EnterEventMode,
    /// `fmi2NewDiscreteStates`.
    NewDiscreteStates,
    /// `fmi2EnterContinuousTimeMode`.
    EnterContinuousTimeMode,
    /// `fmi2CompletedIntegratorStep`.
    CompletedIntegratorStep,
    /// `fmi2SetTime`.
    SetTime,
    /// `fmi2SetContinuousStates`.
    SetContinuousStates,
    /// `fmi2GetDerivatives`, `fmi2GetEventIndicators`, `fmi2GetContinuousStates`, `fmi2GetNominalsOfContinuousStates`.
    GetContinuous,
}

impl Call {
    /// The columns: instantiated, initialization, step (co-simulation), event, continuous (model exchange), terminated,
    /// failed. Reading is allowed in "instantiated", more than the standard asks: some simulators read every variable
    /// as soon as there is an instance.
    #[rustfmt::skip]
    const fn row(self) -> [bool; 7] {
        const YES: bool = true;
        const NO: bool = false;
        match self {
            //                              inst. init. step  event cont. term. failed
            Call::SetDebugLogging          => [YES, YES, YES, YES, YES, YES, YES],
            Call::SetupExperiment          => [YES, NO,  NO,  NO,  NO,  NO,  NO ],
            Call::EnterInitializationMode  => [YES, NO,  NO,  NO,  NO,  NO,  NO ],
            Call::ExitInitializationMode   => [NO,  YES, NO,  NO,  NO,  NO,  NO ],
            Call::Terminate                => [NO,  NO,  YES, YES, YES, NO,  NO ],
            Call::Reset                    => [YES, YES, YES, YES, YES, YES, YES],
            Call::Get                      => [YES, YES, YES, YES, YES, YES, YES],
            Call::Set                      => [YES, YES, YES, YES, YES, NO,  NO ],
            Call::State                    => [YES, YES, YES, YES, YES, YES, YES],
            Call::GetDirectionalDerivative => [NO,  NO,  NO,  NO,  NO,  NO,  NO ],
            Call::SetRealInputDerivatives  => [YES, YES, YES, NO,  NO,  NO,  NO ],
            Call::GetRealOutputDerivatives => [NO,  NO,  YES, NO,  NO,  YES, NO ],
            Call::DoStep                   => [NO,  NO,  YES, NO,  NO,  NO,  NO ],
            Call::CancelStep               => [NO,  NO,  NO,  NO,  NO,  NO,  NO ],
            Call::GetStatus                => [NO,  NO,  YES, NO,  NO,  YES, YES],
            Call::EnterEventMode           => [NO,  NO,  NO,  YES, YES, NO,  NO ],
            Call::NewDiscreteStates        => [NO,  NO,  NO,  YES, NO,  NO,  NO ],
            Call::EnterContinuousTimeMode  => [NO,  NO,  NO,  YES, NO,  NO,  NO ],
            Call::CompletedIntegratorStep  => [NO,  NO,  NO,  NO,  YES, NO,  NO ],
            Call::SetTime                  => [NO,  NO,  NO,  YES, YES, NO,  NO ],
            Call::SetContinuousStates      => [NO,  NO,  NO,  NO,  YES, NO,  NO ],
            Call::GetContinuous            => [NO,  YES, NO,  YES, YES, YES, YES],
        }
    }

    /// Whether the call is allowed in that state.
    pub const fn allowed(self, phase: Phase) -> bool {
        self.row()[phase as usize]
    }
}
