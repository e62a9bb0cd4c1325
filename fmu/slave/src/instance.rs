//! One instance, without a raw pointer: the state machine, its values, its saved states.
//!
//! Invariant: a refused call changes nothing.

use crate::calls::{Call, Phase};
use crate::description::{Causality, Interface, Variability};
use crate::log::{Category, Log, seconds};
use crate::memory::{self, OutOfMemory};
use crate::seal::{self, SealError};
use crate::slave::{Slave, SlaveError};
use crate::states::States;
use crate::values::{Value, ValueError, Values};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A state as it is used ÷ as it is written, at most, with the bytes themselves: a small number takes one byte of
/// eight.
const UNPACKED: usize = 9;

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
    /// There is too little memory.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
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
    /// A stop time that is none.
    #[error("stop time {stop} s does not come after start time {start} s")]
    StopTime {
        /// As given, s.
        start: f64,
        /// As given, s.
        stop: f64,
    },
    /// A step beyond the stop time.
    #[error(
        "a step from t = {} s over h = {} s ends after the stop time {stop} s that fmi2SetupExperiment gave: set a later one",
        seconds(*time), seconds(*step)
    )]
    BeyondStop {
        /// Communication point, s.
        time: f64,
        /// Step, s.
        step: f64,
        /// Stop time, s.
        stop: f64,
    },
    /// What keeps an instance from being initialised.
    #[error(
        "{source}. Not initialised: set it anew and call fmi2ExitInitializationMode again; a simulator that ends here can only call \
         fmi2Reset, after which all parameters are at their defaults"
    )]
    Initialization {
        /// Why.
        source: Box<CallError>,
    },
    /// A handle that is none.
    #[error(
        "this FMUstate is none that this instance holds: it was freed, is another instance's, or its address was passed in its place; to \
         move a state, serialise it"
    )]
    NoSuchState,
    /// Bytes that are no saved state of this FMU.
    #[error("no state of this FMU (GUID {guid}): {source}")]
    Sealed {
        /// GUID of this FMU.
        guid: String,
        /// What was found.
        source: SealError,
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
    /// An array of states that is not as long as there are states.
    #[error("{given} values for {needed} continuous states: modelDescription.xml has as many derivatives")]
    StateCount {
        /// Length of the host's array.
        given: usize,
        /// How many states there are.
        needed: usize,
    },
    /// States that are no numbers.
    #[error("continuous state {number} is {value}: it must be a finite number")]
    NotFinite {
        /// Which one, from 1.
        number: usize,
        /// As given.
        value: f64,
    },
    /// A present time that is none.
    #[error("t = {time} s is no finite number")]
    Time {
        /// As given, s.
        time: f64,
    },
    /// Something the FMU does not offer.
    #[error("{what} is not offered by this FMU; modelDescription.xml says so")]
    NotOffered {
        /// What was asked for.
        what: &'static str,
    },
}

fn mend(call: Call, phase: Phase) -> &'static str {
    match (call, phase) {
        (Call::GetDirectionalDerivative, _) => ": this FMU has none, as its modelDescription.xml says",
        (Call::CancelStep, _) => ": every step is finished when fmi2DoStep returns",
        (_, Phase::Failed) => ": call fmi2Reset or set a saved state",
        (Call::DoStep, Phase::Instantiated | Phase::Initialization) => ": initialise first",
        (Call::DoStep, Phase::Event | Phase::Continuous) => ": it was instantiated for model exchange",
        (Call::NewDiscreteStates, Phase::Continuous) => ": call fmi2EnterEventMode first",
        (Call::SetContinuousStates | Call::CompletedIntegratorStep, Phase::Event) => {
            ": call fmi2EnterContinuousTimeMode first"
        }
        (Call::DoStep, Phase::Terminated) => ": call fmi2Reset first",
        _ => "",
    }
}

/// By which share of itself the end of a step may miss the stop time: hosts add steps up, and compare times so.
const STOP_TOLERANCE: f64 = 1e-9;

/// Everything that a step changes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot<S> {
    guid: String,
    /// Whether the host integrates it.
    exchange: bool,
    pub(crate) phase: Phase,
    start_time: f64,
    stop_time: Option<f64>,
    pub(crate) time: f64,
    /// Whether the outputs hold for the parameters as they are set.
    started: bool,
    pub(crate) values: Values,
    pub(crate) slave: S,
}

impl<S: Slave> Snapshot<S> {
    fn fresh(interface: &Interface, slave: &S, exchange: bool) -> Snapshot<S> {
        Snapshot {
            guid: interface.guid.clone(),
            exchange,
            phase: Phase::Instantiated,
            start_time: 0.0,
            stop_time: None,
            time: 0.0,
            started: false,
            values: Values::start(&interface.description),
            slave: slave.clone(),
        }
    }
}

/// One instance of a slave.
pub struct Instance<S> {
    interface: Interface,
    fresh: S,
    /// Where the time stands among the variables.
    time_place: Option<usize>,
    pub(crate) state: Snapshot<S>,
    states: States<Snapshot<S>>,
    /// Where the host's messages go.
    pub log: Log,
    /// Texts handed to the host; they live until the next call that hands out some.
    pub texts: Vec<std::ffi::CString>,
}

impl<S: Slave> Instance<S> {
    /// An instance of a slave as read from its resources, for model exchange or for co-simulation.
    pub fn new(interface: Interface, slave: S, log: Log, exchange: bool) -> Instance<S> {
        let state = Snapshot::fresh(&interface, &slave, exchange);
        Instance {
            time_place: interface.description.time(),
            interface,
            fresh: slave,
            state,
            states: States::new(),
            log,
            texts: Vec::new(),
        }
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
    /// [`CallError::StartTime`], [`CallError::StopTime`].
    pub fn setup(&mut self, start_time: f64, stop_time: Option<f64>) -> Result<(), CallError> {
        if !start_time.is_finite() {
            return Err(CallError::StartTime { time: start_time });
        }
        if let Some(stop) = stop_time.filter(|stop| stop.is_nan() || *stop < start_time) {
            return Err(CallError::StopTime { start: start_time, stop });
        }
        self.state.start_time = start_time;
        self.state.stop_time = stop_time;
        self.show_time(start_time);
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
        self.start().map_err(|source| CallError::Initialization { source: source.into() })?;
        self.state.phase = if self.state.exchange { Phase::Event } else { Phase::Step };
        Ok(())
    }

    fn start(&mut self) -> Result<(), CallError> {
        if self.state.started {
            return Ok(());
        }
        self.state.values.check_parameters(&self.interface.description)?;
        memory::ask(S::ROOM)?;
        let mut slave = self.fresh.clone();
        let (time, values) = (self.state.start_time, &mut self.state.values);
        match self.state.exchange {
            true => slave.start_continuous(time, values, &mut self.log)?,
            false => slave.start(time, values, &mut self.log)?,
        }
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
        let changed = self.state.values.changed_parameters(&self.interface.description);
        self.state = Snapshot::fresh(&self.interface, &self.fresh, self.state.exchange);
        self.log.forget();
        if !changed.is_empty() {
            let text = format!("reset: {} at the default again, set anew what the next run needs", changed.join(", "));
            self.log.say(Category::Warning, &text);
        }
    }

    /// `fmi2DoStep`.
    ///
    /// # Errors
    /// [`CallError::Step`], [`CallError::BeyondStop`], or what leaves the slave unable to go on.
    pub fn step(&mut self, time: f64, step: f64) -> Result<(), CallError> {
        if !(time.is_finite() && step.is_finite() && step >= 0.0) {
            return Err(CallError::Step { time, step });
        }
        let end = time + step;
        if let Some(stop) = self.state.stop_time.filter(|stop| end > stop + STOP_TOLERANCE * end.abs()) {
            return Err(CallError::BeyondStop { time, step, stop });
        }
        self.state.slave.step(time, step, &mut self.state.values, &mut self.log)?;
        self.show_time(end);
        Ok(())
    }

    /// Moves the time on, also as a variable.
    pub(crate) fn show_time(&mut self, time: f64) {
        self.state.time = time;
        if let Some(place) = self.time_place {
            self.state.values.put(place, Value::Real(time));
        }
    }

    /// Makes the outputs fit the parameters, where these can still change, and in model exchange time and states.
    ///
    /// # Errors
    /// A parameter that is refused.
    pub fn refresh(&mut self) -> Result<(), CallError> {
        if self.state.phase == Phase::Initialization {
            self.start()?;
        }
        if let Some(continuous) = self.state.slave.continuous() {
            continuous.show(&mut self.state.values);
        }
        Ok(())
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
            (Causality::Output | Causality::Local | Causality::Independent, _) => {
                Err(ValueError::Output { name: name() })
            }
            (Causality::Parameter, phase) if phase.runs() && present != value => {
                Err(ValueError::Fixed { name: name() })
            }
            (Causality::Input, Phase::Continuous) if variable.variability == Variability::Discrete => {
                Err(ValueError::Discrete { name: name() })
            }
            _ => Ok(()),
        }
    }

    /// Sets a value that [`Instance::check_set`] let pass.
    pub fn set(&mut self, reference: usize, value: Value) {
        self.state.values.put(reference, value);
        self.state.started &= self.state.phase.runs();
    }

    fn wrong_type(&self, reference: usize, value: &Value, asked: &'static str) -> ValueError {
        let name = self.interface.description.variables[reference].name.clone();
        ValueError::WrongType { name, actual: value.type_name(), asked }
    }

    /// `fmi2GetFMUstate`: a copy of the state, under the handle given where the host holds one, and that handle.
    pub fn save(&mut self, handle: usize) -> usize {
        self.states.keep(handle, self.state.clone())
    }

    /// `fmi2SetFMUstate`.
    ///
    /// # Errors
    /// [`CallError::NoSuchState`].
    pub fn restore(&mut self, handle: usize) -> Result<(), CallError> {
        self.state = self.states.get(handle).ok_or(CallError::NoSuchState)?.clone();
        Ok(())
    }

    /// `fmi2FreeFMUstate`.
    ///
    /// # Errors
    /// [`CallError::NoSuchState`].
    pub fn free(&mut self, handle: usize) -> Result<(), CallError> {
        if self.states.free(handle) { Ok(()) } else { Err(CallError::NoSuchState) }
    }

    /// `fmi2SerializedFMUstateSize`.
    ///
    /// # Errors
    /// [`CallError::NoSuchState`], [`CallError::Serialise`].
    pub fn packed_size(&mut self, handle: usize) -> Result<usize, CallError> {
        let packed = self.states.packed(handle, to_bytes).ok_or(CallError::NoSuchState)??;
        Ok(packed.as_ref().map_or(0, Vec::len))
    }

    /// `fmi2SerializeFMUstate`: the state as bytes, every number bit by bit, into the host's room.
    ///
    /// # Errors
    /// [`CallError::NoSuchState`], [`CallError::Serialise`], [`CallError::TooFewBytes`].
    pub fn pack(&mut self, handle: usize, room: &mut [u8]) -> Result<(), CallError> {
        let packed = self.states.packed(handle, to_bytes).ok_or(CallError::NoSuchState)??;
        let bytes = packed.as_deref().unwrap_or_default();
        let too_few = CallError::TooFewBytes { given: room.len(), needed: bytes.len() };
        room.get_mut(..bytes.len()).ok_or(too_few)?.copy_from_slice(bytes);
        *packed = None;
        Ok(())
    }

    /// `fmi2DeSerializeFMUstate`: as [`Instance::save`], for the state that the bytes hold.
    ///
    /// # Errors
    /// [`CallError::Sealed`] for bytes that are no state of this FMU.
    pub fn unpack(&mut self, bytes: &[u8], handle: usize) -> Result<usize, CallError> {
        let state =
            self.read(bytes).map_err(|source| CallError::Sealed { guid: self.interface.guid.clone(), source })?;
        Ok(self.states.keep(handle, state))
    }

    fn read(&self, bytes: &[u8]) -> Result<Snapshot<S>, SealError> {
        let content = |why: String| SealError::Content { why };
        let state = seal::open(bytes, &self.interface.guid)?;
        let (size, _) = lz4_flex::block::uncompressed_size(state).map_err(|error| content(error.to_string()))?;
        memory::ask(UNPACKED * size + S::ROOM).map_err(|error| content(error.to_string()))?;
        let state = lz4_flex::decompress_size_prepended(state).map_err(|error| content(error.to_string()))?;
        let saved: Snapshot<S> = postcard::from_bytes(&state).map_err(|error| content(error.to_string()))?;
        if saved.exchange != self.state.exchange {
            return Err(content(
                "it is one of model exchange, and this instance for co-simulation, or the reverse".into(),
            ));
        }
        match saved.values.same_shape(&self.state.values) {
            true => Ok(saved),
            false => Err(content("its variables are others".into())),
        }
    }
}

fn to_bytes<S: Slave>(saved: &Snapshot<S>) -> Result<Vec<u8>, CallError> {
    let state = postcard::to_stdvec(saved).map_err(CallError::Serialise)?;
    let mut bytes = seal::head(&saved.guid);
    bytes.extend(lz4_flex::compress_prepend_size(&state));
    seal::seal(&mut bytes);
    Ok(bytes)
}
