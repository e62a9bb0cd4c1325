//! A small FMI 2.0 importer for tests: takes a slave's functions linked in, and calls them.
//!
//! It is no simulator: it does what it is told, also what the standard forbids, and keeps every message.

mod counting;
mod exchange;
mod mistakes;

pub use counting::Counting;
pub use exchange::Exchange;
pub use mistakes::Mistake;

use crate::ctypes::*;
use std::ffi::{CStr, CString, c_void};
use std::ptr::null_mut;
use std::sync::Mutex;

type Vr = *const ValueReference;

macro_rules! function_table {
    ($(#[$text:meta])* $table:ident $linked:ident: $($field:ident = $symbol:ident: ($($argument:ty),*) -> $result:ty;)*) => {
        $(#[$text])*
        #[derive(Clone, Copy)]
        pub struct $table {
            $(#[doc = concat!("`", stringify!($symbol), "`.")] pub $field: unsafe extern "C" fn($($argument),*) -> $result,)*
        }

        impl $table {
            /// Their names.
            pub const NAMES: &[&str] = &[$(stringify!($symbol)),*];

            /// The functions of a dynamic library, which stays loaded.
            ///
            /// # Errors
            /// The library or the function that is missing.
            pub fn load(path: &std::path::Path) -> Result<$table, libloading::Error> {
                // SAFETY: the library is an FMU's, of which FMI says what it exports; it is never unloaded.
                unsafe {
                    let library = std::mem::ManuallyDrop::new(libloading::Library::new(path)?);
                    Ok($table { $($field: *library.get(concat!(stringify!($symbol), "\0").as_bytes())?,)* })
                }
            }
        }

        /// That table of what `export!` or `export_exchange!` made in a module, which must be in scope.
        #[macro_export]
        macro_rules! $linked {
            ($module:ident) => { $crate::host::$table { $($field: $module::$symbol,)* } };
        }
    };
}

function_table! {
    /// The 34 functions of a slave.
    Functions linked_functions:
    types_platform = fmi2GetTypesPlatform: () -> Text;
    version = fmi2GetVersion: () -> Text;
    set_debug_logging = fmi2SetDebugLogging: (Component, Boolean, usize, *const Text) -> Status;
    instantiate = fmi2Instantiate: (Text, FmuType, Text, Text, *const CallbackFunctions, Boolean, Boolean) -> Component;
    free_instance = fmi2FreeInstance: (Component) -> Nothing;
    setup_experiment = fmi2SetupExperiment: (Component, Boolean, Real, Real, Boolean, Real) -> Status;
    enter_initialization = fmi2EnterInitializationMode: (Component) -> Status;
    exit_initialization = fmi2ExitInitializationMode: (Component) -> Status;
    terminate = fmi2Terminate: (Component) -> Status;
    reset = fmi2Reset: (Component) -> Status;
    get_real = fmi2GetReal: (Component, Vr, usize, *mut Real) -> Status;
    get_integer = fmi2GetInteger: (Component, Vr, usize, *mut Integer) -> Status;
    get_boolean = fmi2GetBoolean: (Component, Vr, usize, *mut Boolean) -> Status;
    get_string = fmi2GetString: (Component, Vr, usize, *mut Text) -> Status;
    set_real = fmi2SetReal: (Component, Vr, usize, *const Real) -> Status;
    set_integer = fmi2SetInteger: (Component, Vr, usize, *const Integer) -> Status;
    set_boolean = fmi2SetBoolean: (Component, Vr, usize, *const Boolean) -> Status;
    set_string = fmi2SetString: (Component, Vr, usize, *const Text) -> Status;
    get_state = fmi2GetFMUstate: (Component, *mut FmuState) -> Status;
    set_state = fmi2SetFMUstate: (Component, FmuState) -> Status;
    free_state = fmi2FreeFMUstate: (Component, *mut FmuState) -> Status;
    serialized_size = fmi2SerializedFMUstateSize: (Component, FmuState, *mut usize) -> Status;
    serialize = fmi2SerializeFMUstate: (Component, FmuState, *mut Byte, usize) -> Status;
    deserialize = fmi2DeSerializeFMUstate: (Component, *const Byte, usize, *mut FmuState) -> Status;
    directional_derivative = fmi2GetDirectionalDerivative:
        (Component, Vr, usize, Vr, usize, *const Real, *mut Real) -> Status;
    input_derivatives = fmi2SetRealInputDerivatives: (Component, Vr, usize, *const Integer, *const Real) -> Status;
    output_derivatives = fmi2GetRealOutputDerivatives: (Component, Vr, usize, *const Integer, *mut Real) -> Status;
    do_step = fmi2DoStep: (Component, Real, Real, Boolean) -> Status;
    cancel_step = fmi2CancelStep: (Component) -> Status;
    get_status = fmi2GetStatus: (Component, StatusKind, *mut Status) -> Status;
    get_real_status = fmi2GetRealStatus: (Component, StatusKind, *mut Real) -> Status;
    get_integer_status = fmi2GetIntegerStatus: (Component, StatusKind, *mut Integer) -> Status;
    get_boolean_status = fmi2GetBooleanStatus: (Component, StatusKind, *mut Boolean) -> Status;
    get_string_status = fmi2GetStringStatus: (Component, StatusKind, *mut Text) -> Status;
}

function_table! {
    /// The ten functions that model exchange has besides.
    ExchangeFunctions linked_exchange_functions:
    enter_event_mode = fmi2EnterEventMode: (Component) -> Status;
    new_discrete_states = fmi2NewDiscreteStates: (Component, *mut EventInfo) -> Status;
    enter_continuous_time_mode = fmi2EnterContinuousTimeMode: (Component) -> Status;
    completed_integrator_step = fmi2CompletedIntegratorStep: (Component, Boolean, *mut Boolean, *mut Boolean) -> Status;
    set_time = fmi2SetTime: (Component, Real) -> Status;
    set_states = fmi2SetContinuousStates: (Component, *const Real, usize) -> Status;
    derivatives = fmi2GetDerivatives: (Component, *mut Real, usize) -> Status;
    event_indicators = fmi2GetEventIndicators: (Component, *mut Real, usize) -> Status;
    states = fmi2GetContinuousStates: (Component, *mut Real, usize) -> Status;
    nominals = fmi2GetNominalsOfContinuousStates: (Component, *mut Real, usize) -> Status;
}

/// What a slave said: status, category, text.
pub type Message = (Status, String, String);

type Messages = Mutex<Vec<Message>>;

unsafe extern "C" fn keep(environment: *mut c_void, _: Text, status: Status, category: Text, format: Text) {
    // SAFETY: the environment is the host's list; texts end with a zero byte.
    let (messages, category, format) =
        unsafe { (&*environment.cast::<Messages>(), CStr::from_ptr(category), CStr::from_ptr(format)) };
    let text = format.to_string_lossy();
    assert!(!text.replace("%%", "").contains('%'), "a format that asks for arguments: {text}");
    if let Ok(mut messages) = messages.lock() {
        messages.push((status, category.to_string_lossy().into_owned(), text.replace("%%", "%")));
    }
}

/// A state that the slave holds for the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Saved(FmuState);

impl Saved {
    /// No state.
    pub const NULL: Saved = Saved(null_mut());

    /// What a host passes that confuses pointers: any address.
    pub fn at(address: usize) -> Saved {
        Saved(std::ptr::without_provenance_mut(address))
    }
}

/// What to instantiate.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// `fmi2CoSimulation` or not.
    pub co_simulation: bool,
    /// GUID.
    pub guid: &'a str,
    /// Resource location; `None` passes NULL.
    pub location: Option<&'a str>,
    /// Whether logging is on.
    pub logging: bool,
}

/// One instance and what it said. Calls return the `fmi2Status` as it came.
pub struct Instance {
    functions: Functions,
    component: Component,
    callbacks: Box<CallbackFunctions>,
}

impl Instance {
    /// `fmi2Instantiate`.
    ///
    /// # Errors
    /// What the slave said instead.
    pub fn new(functions: Functions, request: &Request) -> Result<Instance, Vec<Message>> {
        let messages = Box::into_raw(Box::new(Messages::default())).cast::<c_void>();
        // SAFETY: the slave passes no arguments behind the format, so that a callback without "..." reads what it is
        // given on every platform that FMI knows.
        let logger = unsafe { std::mem::transmute::<*const (), LoggerCallback>(keep as *const ()) };
        let callbacks = Box::new(CallbackFunctions {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: messages,
        });
        let (guid, location) = (c_text(request.guid), request.location.map(c_text));
        let location = location.as_ref().map_or(std::ptr::null(), |text| text.as_ptr());
        let logging = Boolean::from(request.logging);
        let kind = FmuType::from(request.co_simulation);
        let name = c"an instance, 100 %".as_ptr();
        // SAFETY: every pointer outlives the call, the callbacks outlive the instance.
        let component =
            unsafe { (functions.instantiate)(name, kind, guid.as_ptr(), location, &raw const *callbacks, 0, logging) };
        let instance = Instance { functions, component, callbacks };
        if component.is_null() { Err(instance.messages()) } else { Ok(instance) }
    }

    /// What the slave has said so far.
    pub fn messages(&self) -> Vec<Message> {
        // SAFETY: the list lives as long as the instance.
        let messages = unsafe { &*self.callbacks.component_environment.cast::<Messages>() };
        messages.lock().map(|list| list.clone()).unwrap_or_default()
    }

    /// Any call: the functions and the component, to be used as the standard says, or not.
    pub fn call<T>(&self, call: impl FnOnce(&Functions, Component) -> T) -> T {
        call(&self.functions, self.component)
    }

    /// From a fresh instance to the first step.
    pub fn initialize(&self, start: f64) -> Status {
        // SAFETY: the component is alive, here and in all calls below.
        self.call(|f, c| unsafe {
            let setup = (f.setup_experiment)(c, 0, 0.0, start, 0, 0.0);
            setup.max((f.enter_initialization)(c)).max((f.exit_initialization)(c))
        })
    }

    /// `fmi2DoStep`.
    pub fn step(&self, time: f64, step: f64) -> Status {
        self.call(|f, c| unsafe { (f.do_step)(c, time, step, 1) })
    }

    /// `fmi2SetupExperiment` alone.
    pub fn setup(&self, start: f64) -> Status {
        self.call(|f, c| unsafe { (f.setup_experiment)(c, 0, 0.0, start, 0, 0.0) })
    }

    /// `fmi2SetupExperiment` with a stop time.
    pub fn setup_until(&self, start: f64, stop: f64) -> Status {
        self.call(|f, c| unsafe { (f.setup_experiment)(c, 0, 0.0, start, 1, stop) })
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter(&self) -> Status {
        self.call(|f, c| unsafe { (f.enter_initialization)(c) })
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit(&self) -> Status {
        self.call(|f, c| unsafe { (f.exit_initialization)(c) })
    }

    /// `fmi2Terminate`.
    pub fn terminate(&self) -> Status {
        self.call(|f, c| unsafe { (f.terminate)(c) })
    }

    /// `fmi2Reset`.
    pub fn reset(&self) -> Status {
        self.call(|f, c| unsafe { (f.reset)(c) })
    }

    /// `fmi2SetReal`.
    pub fn set_reals(&self, references: &[u32], values: &[f64]) -> Status {
        self.call(|f, c| unsafe { (f.set_real)(c, references.as_ptr(), references.len(), values.as_ptr()) })
    }

    /// `fmi2SetInteger`.
    pub fn set_integer(&self, reference: u32, value: i32) -> Status {
        self.call(|f, c| unsafe { (f.set_integer)(c, &reference, 1, &value) })
    }

    /// `fmi2SetBoolean`.
    pub fn set_boolean(&self, reference: u32, value: i32) -> Status {
        self.call(|f, c| unsafe { (f.set_boolean)(c, &reference, 1, &value) })
    }

    /// `fmi2SetString`.
    pub fn set_text(&self, reference: u32, value: &str) -> Status {
        let value = c_text(value);
        self.call(|f, c| unsafe { (f.set_string)(c, &reference, 1, &value.as_ptr()) })
    }

    /// `fmi2GetReal`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn reals(&self, references: &[u32]) -> Result<Vec<f64>, Status> {
        let mut values = vec![f64::NAN; references.len()];
        let out = values.as_mut_ptr();
        ok(self.call(|f, c| unsafe { (f.get_real)(c, references.as_ptr(), references.len(), out) }), values)
    }

    /// `fmi2GetInteger`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn integer(&self, reference: u32) -> Result<i32, Status> {
        let mut value = 0;
        ok(self.call(|f, c| unsafe { (f.get_integer)(c, &reference, 1, &mut value) }), ()).map(|()| value)
    }

    /// `fmi2GetBoolean`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn boolean(&self, reference: u32) -> Result<i32, Status> {
        let mut value = 0;
        ok(self.call(|f, c| unsafe { (f.get_boolean)(c, &reference, 1, &mut value) }), ()).map(|()| value)
    }

    /// `fmi2GetString`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn text(&self, reference: u32) -> Result<String, Status> {
        let mut value: Text = std::ptr::null();
        ok(self.call(|f, c| unsafe { (f.get_string)(c, &reference, 1, &mut value) }), ())?;
        Ok(unsafe { CStr::from_ptr(value) }.to_string_lossy().into_owned())
    }

    /// `fmi2GetFMUstate`; goes with [`Instance::free`].
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn save(&self) -> Result<Saved, Status> {
        let mut state = null_mut();
        ok(self.call(|f, c| unsafe { (f.get_state)(c, &mut state) }), ()).map(|()| Saved(state))
    }

    /// `fmi2GetFMUstate` into a slot that holds something already.
    pub fn save_into(&self, state: &mut Saved) -> Status {
        self.call(|f, c| unsafe { (f.get_state)(c, &mut state.0) })
    }

    /// `fmi2SetFMUstate` with a state that [`Instance::save`] or [`Instance::unpack`] gave.
    pub fn restore(&self, state: Saved) -> Status {
        self.call(|f, c| unsafe { (f.set_state)(c, state.0) })
    }

    /// `fmi2FreeFMUstate`.
    pub fn free(&self, state: &mut Saved) -> Status {
        self.call(|f, c| unsafe { (f.free_state)(c, &mut state.0) })
    }

    /// `fmi2SerializeFMUstate` into a buffer of that size, whether it is large enough or not.
    pub fn pack_into(&self, state: Saved, size: usize) -> Status {
        let mut bytes = vec![0_u8; size];
        let out = bytes.as_mut_ptr().cast();
        self.call(|f, c| unsafe { (f.serialize)(c, state.0, out, size) })
    }

    /// `fmi2SerializedFMUstateSize` and `fmi2SerializeFMUstate`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn pack(&self, state: Saved) -> Result<Vec<u8>, Status> {
        let mut size = 0;
        ok(self.call(|f, c| unsafe { (f.serialized_size)(c, state.0, &mut size) }), ())?;
        let mut bytes = vec![0_u8; size];
        let out = bytes.as_mut_ptr().cast();
        ok(self.call(|f, c| unsafe { (f.serialize)(c, state.0, out, size) }), bytes)
    }

    /// `fmi2DeSerializeFMUstate`.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn unpack(&self, bytes: &[u8]) -> Result<Saved, Status> {
        let mut state = null_mut();
        let start = bytes.as_ptr().cast();
        ok(self.call(|f, c| unsafe { (f.deserialize)(c, start, bytes.len(), &mut state) }), ()).map(|()| Saved(state))
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: nothing uses the component or its messages after this.
        unsafe {
            (self.functions.free_instance)(self.component);
            drop(Box::from_raw(self.callbacks.component_environment.cast::<Messages>()));
        }
    }
}

fn ok<T>(status: Status, value: T) -> Result<T, Status> {
    if status == OK { Ok(value) } else { Err(status) }
}

fn c_text(text: &str) -> CString {
    crate::log::c_text(text)
}
