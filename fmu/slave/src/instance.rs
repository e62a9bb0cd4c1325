//! One instance, without a raw pointer: the state machine, its values, its saved states.
//!
//! Invariant: a refused call changes nothing.

use crate::calls::{Call, Phase};
use crate::description::{Causality, Interface};
use crate::log::{Category, Log};
use crate::slave::{Slave, SlaveError};
use crate::values::{Value, ValueError, Values};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why a call is refused.
#[derive(Debug, Error)]
pub enum CallError {
    /// The state machine forbids it.
    #[error("{call:?} is not allowed while the instance is in state {phase:?}{}", mend(*call, *phase))]
    NotNow {
        /// The call.
        call: Call,
        /// The state.
        phase: Phase,
    },
    /// A variable cannot be read or set.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// The slave refuses.
    #[error("{0}")]
    Slave(#[from] SlaveError),
    /// A null pointer where there must be none.
    #[error("{what} is a null pointer")]
    Null {
        /// The argument.
        what: &'static str,
    },
    /// Times that are no times.
    #[error("a step from t = {time} s over h = {step} s is impossible: t must be finite, h finite and not negative")]
    Step {
        /// Communication point, s.
        time: f64,
        /// Step, s.
        step: f64,
    },
    /// A start time that is none.
    #[error("start time {time} s is no finite number")]
    StartTime {
        /// As given, s.
        time: f64,
    },
    /// A saved state of something else.
    #[error("this saved state does not belong to this FMU (GUID {expected}): {found}")]
    ForeignState {
        /// GUID of this FMU.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The bytes are too short for the state.
    #[error("{given} bytes are too few for the state: ask fmi2SerializedFMUstateSize, it needs {needed}")]
    TooFewBytes {
        /// Size of the host's buffer.
        given: usize,
        /// Size needed.
        needed: usize,
    },
    /// The state cannot be written.
    #[error("the state cannot be serialised: {0}")]
    Serialise(postcard::Error),
    /// Something the FMU does not offer.
    #[error("{what} is not offered by this FMU; modelDescription.xml says so")]
    NotOffered {
        /// What was asked for.
        what: &'static str,
    },
}

fn mend(call: Call, phase: Phase) -> &'static str {
    match (call, phase) {
        (_, Phase::Failed) => ": call fmi2Reset or set a saved state",
        (Call::DoStep, Phase::Instantiated | Phase::Initialization) => ": initialise first",
        (Call::DoStep, Phase::Terminated) => ": call fmi2Reset first",
        _ => "",
    }
}

/// Everything that a step changes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot<S> {
    guid: String,
    phase: Phase,
    start_time: f64,
    time: f64,
    /// Whether the outputs hold for the parameters as they are set.
    started: bool,
    values: Values,
    slave: S,
}

/// One instance of a slave.
pub struct Instance<S> {
    interface: Interface,
    fresh: S,
    state: Snapshot<S>,
    /// Where the host's messages go.
    pub log: Log,
    /// Texts handed to the host; they live until the next call that hands out some.
    pub texts: Vec<std::ffi::CString>,
}

impl<S: Slave> Instance<S> {
    /// An instance of a slave as read from its resources.
    pub fn new(interface: Interface, slave: S, log: Log) -> Instance<S> {
        let state = Snapshot {
            guid: interface.guid.clone(),
            phase: Phase::Instantiated,
            start_time: 0.0,
            time: 0.0,
            started: false,
            values: Values::start(&interface.description),
            slave: slave.clone(),
        };
        Instance { interface, fresh: slave, state, log, texts: Vec::new() }
    }

    /// Refuses what the state machine forbids.
    ///
    /// # Errors
    /// [`CallError::NotNow`].
    pub fn permit(&self, call: Call) -> Result<(), CallError> {
        let phase = self.state.phase;
        if call.allowed(phase) { Ok(()) } else { Err(CallError::NotNow { call, phase }) }
    }

    /// Time up to which the last step went, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Says why a call failed.
    pub fn complain(&mut self, error: &CallError) {
        self.log.say(Category::Error, &error.to_string());
    }

    /// After a panic: nothing but reset, restore and free is possible.
    pub fn fail(&mut self, message: &str) {
        self.state.phase = Phase::Failed;
        let text = format!("internal failure, please report it: {message}; fmi2Reset or a saved state brings it back");
        self.log.say(Category::Error, &text);
    }

    /// `fmi2SetupExperiment`.
    ///
    /// # Errors
    /// [`CallError::StartTime`].
    pub fn setup(&mut self, start_time: f64) -> Result<(), CallError> {
        if !start_time.is_finite() {
            return Err(CallError::StartTime { time: start_time });
        }
        self.state.start_time = start_time;
        self.state.time = start_time;
        self.state.started = false;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization(&mut self) {
        self.state.phase = Phase::Initialization;
    }

    /// `fmi2ExitInitializationMode`: the parameters are taken.
    ///
    /// # Errors
    /// A parameter that is refused; the instance stays in initialization, where it can be mended.
    pub fn exit_initialization(&mut self) -> Result<(), CallError> {
        self.start()?;
        self.state.phase = Phase::Step;
        Ok(())
    }

    fn start(&mut self) -> Result<(), CallError> {
        if self.state.started {
            return Ok(());
        }
        self.state.values.check_parameters(&self.interface.description)?;
        let mut slave = self.fresh.clone();
        slave.start(self.state.start_time, &mut self.state.values, &mut self.log)?;
        self.state.slave = slave;
        self.state.started = true;
        Ok(())
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) {
        self.state.phase = Phase::Terminated;
    }

    /// `fmi2Reset`: as after `fmi2Instantiate`.
    pub fn reset(&mut self) {
        self.state = Snapshot {
            guid: self.interface.guid.clone(),
            phase: Phase::Instantiated,
            start_time: 0.0,
            time: 0.0,
            started: false,
            values: Values::start(&self.interface.description),
            slave: self.fresh.clone(),
        };
        self.log.forget();
    }

    /// `fmi2DoStep`.
    ///
    /// # Errors
    /// [`CallError::Step`], or what leaves the slave unable to go on.
    pub fn step(&mut self, time: f64, step: f64) -> Result<(), CallError> {
        if !(time.is_finite() && step.is_finite() && step >= 0.0) {
            return Err(CallError::Step { time, step });
        }
        self.state.slave.step(time, step, &mut self.state.values, &mut self.log)?;
        self.state.time = time + step;
        Ok(())
    }

    /// Makes the outputs fit the parameters, where these can still change.
    ///
    /// # Errors
    /// A parameter that is refused.
    pub fn refresh(&mut self) -> Result<(), CallError> {
        if self.state.phase == Phase::Initialization { self.start() } else { Ok(()) }
    }

    /// The value at that reference as the call's type.
    ///
    /// # Errors
    /// [`ValueError::Unknown`], [`ValueError::WrongType`].
    pub fn get<'a, T: 'a>(
        &'a self,
        reference: usize,
        asked: &'static str,
        pick: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<T, ValueError> {
        let value = self.state.values.get(reference)?;
        pick(value).ok_or_else(|| self.wrong_type(reference, value, asked))
    }

    /// Refuses a value that cannot be set now.
    ///
    /// # Errors
    /// Unknown reference, another type, an output, or a fixed parameter after initialization. Setting a parameter to
    /// the value that it has is allowed at any time.
    pub fn check_set(&self, reference: usize, value: &Value) -> Result<(), ValueError> {
        let present = self.state.values.get(reference)?;
        if present.type_name() != value.type_name() {
            return Err(self.wrong_type(reference, present, value.type_name()));
        }
        let variable = &self.interface.description.variables[reference];
        let name = || variable.name.clone();
        match (variable.causality, self.state.phase) {
            (Causality::Output, _) => Err(ValueError::Output { name: name() }),
            (Causality::Parameter, Phase::Step) if present != value => Err(ValueError::Fixed { name: name() }),
            _ => Ok(()),
        }
    }

    /// Sets a value that [`Instance::check_set`] let pass.
    pub fn set(&mut self, reference: usize, value: Value) {
        self.state.values.put(reference, value);
        self.state.started &= self.state.phase == Phase::Step;
    }

    fn wrong_type(&self, reference: usize, value: &Value, asked: &'static str) -> ValueError {
        let name = self.interface.description.variables[reference].name.clone();
        ValueError::WrongType { name, actual: value.type_name(), asked }
    }

    /// `fmi2GetFMUstate`.
    pub fn save(&self) -> Snapshot<S> {
        self.state.clone()
    }

    /// `fmi2SetFMUstate`.
    ///
    /// # Errors
    /// [`CallError::ForeignState`].
    pub fn restore(&mut self, saved: &Snapshot<S>) -> Result<(), CallError> {
        self.check_own(saved)?;
        self.state = saved.clone();
        Ok(())
    }

    fn check_own(&self, saved: &Snapshot<S>) -> Result<(), CallError> {
        let own = saved.guid == self.interface.guid && saved.values.same_shape(&self.state.values);
        let foreign = || CallError::ForeignState {
            expected: self.interface.guid.clone(),
            found: format!("its GUID is {}", saved.guid),
        };
        if own { Ok(()) } else { Err(foreign()) }
    }

    /// `fmi2SerializeFMUstate`: the state as bytes, every number bit by bit.
    ///
    /// # Errors
    /// [`CallError::Serialise`].
    pub fn to_bytes(saved: &Snapshot<S>) -> Result<Vec<u8>, CallError> {
        postcard::to_stdvec(saved).map_err(CallError::Serialise)
    }

    /// `fmi2DeSerializeFMUstate`.
    ///
    /// # Errors
    /// [`CallError::ForeignState`] for bytes that are no state of this FMU.
    pub fn read_bytes(&self, bytes: &[u8]) -> Result<Snapshot<S>, CallError> {
        let unreadable = |error: postcard::Error| CallError::ForeignState {
            expected: self.interface.guid.clone(),
            found: format!("its bytes cannot be read ({error})"),
        };
        let saved = postcard::from_bytes(bytes).map_err(unreadable)?;
        self.check_own(&saved)?;
        Ok(saved)
    }
}
