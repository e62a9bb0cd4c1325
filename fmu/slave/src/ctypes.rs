//! The C types of `fmi2TypesPlatform.h` and `fmi2FunctionTypes.h`.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: one instance.
pub type Component = *mut c_void;
/// `fmi2FMUstate`: one saved state.
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`.
pub type ValueReference = c_uint;
/// `fmi2Real`.
pub type Real = f64;
/// `fmi2Integer`.
pub type Integer = c_int;
/// `fmi2Boolean`: 0 or 1.
pub type Boolean = c_int;
/// `fmi2String`: UTF-8, ends with a zero byte.
pub type Text = *const c_char;
/// `fmi2Byte`.
pub type Byte = c_char;
/// What `fmi2FreeInstance` returns.
pub type Nothing = ();
/// `fmi2Type`: 0 model exchange, 1 co-simulation.
pub type FmuType = c_uint;
/// `fmi2StatusKind`.
pub type StatusKind = c_uint;
/// `fmi2Status`.
pub type Status = c_uint;

/// `fmi2OK`.
pub const OK: Status = 0;
/// `fmi2Warning`.
pub const WARNING: Status = 1;
/// `fmi2Error`.
pub const ERROR: Status = 3;

/// `fmi2ModelExchange`.
pub const MODEL_EXCHANGE: FmuType = 0;
/// `fmi2CoSimulation`.
pub const CO_SIMULATION: FmuType = 1;

/// `fmi2DoStepStatus`.
pub const DO_STEP_STATUS: StatusKind = 0;
/// `fmi2PendingStatus`.
pub const PENDING_STATUS: StatusKind = 1;
/// `fmi2LastSuccessfulTime`.
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
/// `fmi2Terminated`.
pub const TERMINATED: StatusKind = 3;

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct EventInfo {
    /// `newDiscreteStatesNeeded`.
    pub new_discrete_states_needed: Boolean,
    /// `terminateSimulation`.
    pub terminate_simulation: Boolean,
    /// `nominalsOfContinuousStatesChanged`.
    pub nominals_changed: Boolean,
    /// `valuesOfContinuousStatesChanged`.
    pub states_changed: Boolean,
    /// `nextEventTimeDefined`.
    pub next_event_time_defined: Boolean,
    /// `nextEventTime`.
    pub next_event_time: Real,
}

/// `fmi2CallbackLogger`: environment, instance name, status, category, printf format, its arguments.
pub type LoggerCallback = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, ...);

/// `fmi2CallbackFunctions`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CallbackFunctions {
    /// Takes messages.
    pub logger: Option<LoggerCallback>,
    /// Not used: the slave has its own allocator.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: every step is finished when `fmi2DoStep` returns.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    /// Handed back to the logger.
    pub component_environment: *mut c_void,
}
