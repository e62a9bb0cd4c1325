//! The 34 names of FMI 2.0 for co-simulation, and ten more for model exchange.

/// Exports the FMI 2.0 co-simulation interface of a [`Slave`](crate::Slave): once per dynamic library.
#[macro_export]
macro_rules! export {
    ($slave:ty) => {
        $crate::export! { @functions functions interface
            fmi2GetTypesPlatform() -> Text = types_platform();
            fmi2GetVersion() -> Text = version();
            fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, names: *const Text) -> Status
                = set_debug_logging::<$slave>(c, on, n, names);
            fmi2FreeInstance(c: Component) -> Nothing = free_instance::<$slave>(c);
            fmi2SetupExperiment(c: Component, _td: Boolean, _t: Real, start: Real, ends: Boolean, stop: Real) -> Status
                = setup_experiment::<$slave>(c, start, (ends != 0).then_some(stop));
            fmi2EnterInitializationMode(c: Component) -> Status = enter_initialization_mode::<$slave>(c);
            fmi2ExitInitializationMode(c: Component) -> Status = exit_initialization_mode::<$slave>(c);
            fmi2Terminate(c: Component) -> Status = terminate::<$slave>(c);
            fmi2Reset(c: Component) -> Status = reset::<$slave>(c);
            fmi2GetReal(c: Component, vr: *const ValueReference, n: usize, v: *mut Real) -> Status
                = get_real::<$slave>(c, vr, n, v);
            fmi2GetInteger(c: Component, vr: *const ValueReference, n: usize, v: *mut Integer) -> Status
                = get_integer::<$slave>(c, vr, n, v);
            fmi2GetBoolean(c: Component, vr: *const ValueReference, n: usize, v: *mut Boolean) -> Status
                = get_boolean::<$slave>(c, vr, n, v);
            fmi2GetString(c: Component, vr: *const ValueReference, n: usize, v: *mut Text) -> Status
                = get_string::<$slave>(c, vr, n, v);
            fmi2SetReal(c: Component, vr: *const ValueReference, n: usize, v: *const Real) -> Status
                = set_real::<$slave>(c, vr, n, v);
            fmi2SetInteger(c: Component, vr: *const ValueReference, n: usize, v: *const Integer) -> Status
                = set_integer::<$slave>(c, vr, n, v);
            fmi2SetBoolean(c: Component, vr: *const ValueReference, n: usize, v: *const Boolean) -> Status
                = set_boolean::<$slave>(c, vr, n, v);
            fmi2SetString(c: Component, vr: *const ValueReference, n: usize, v: *const Text) -> Status
                = set_string::<$slave>(c, vr, n, v);
            fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = get_fmu_state::<$slave>(c, state);
            fmi2SetFMUstate(c: Component, state: FmuState) -> Status = set_fmu_state::<$slave>(c, state);
            fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = free_fmu_state::<$slave>(c, state);
            fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status
                = serialized_size::<$slave>(c, state, size);
            fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status
                = serialize::<$slave>(c, state, bytes, size);
            fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status
                = deserialize::<$slave>(c, bytes, size, state);
            fmi2GetDirectionalDerivative(c: Component, _u: *const ValueReference, _nu: usize, _k: *const ValueReference,
                _nk: usize, _dk: *const Real, _du: *mut Real) -> Status
                = get_directional_derivative::<$slave>(c);
            fmi2SetRealInputDerivatives(c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer,
                _v: *const Real) -> Status
                = set_real_input_derivatives::<$slave>(c, n);
            fmi2GetRealOutputDerivatives(c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer,
                _v: *mut Real) -> Status
                = get_real_output_derivatives::<$slave>(c, n);
            fmi2DoStep(c: Component, time: Real, step: Real, _no_set_state_prior: Boolean) -> Status
                = do_step::<$slave>(c, time, step);
            fmi2CancelStep(c: Component) -> Status = cancel_step::<$slave>(c);
            fmi2GetStatus(c: Component, kind: StatusKind, v: *mut Status) -> Status = get_status::<$slave>(c, kind, v);
            fmi2GetRealStatus(c: Component, kind: StatusKind, v: *mut Real) -> Status
                = get_real_status::<$slave>(c, kind, v);
            fmi2GetIntegerStatus(c: Component, _kind: StatusKind, v: *mut Integer) -> Status
                = get_integer_status::<$slave>(c, v);
            fmi2GetBooleanStatus(c: Component, kind: StatusKind, v: *mut Boolean) -> Status
                = get_boolean_status::<$slave>(c, kind, v);
            fmi2GetStringStatus(c: Component, kind: StatusKind, v: *mut Text) -> Status
                = get_string_status::<$slave>(c, kind, v);
            fmi2Instantiate(name: Text, kind: FmuType, guid: Text, location: Text,
                functions: *const CallbackFunctions, _visible: Boolean, logging_on: Boolean) -> Component
                = instantiate::<$slave>(name, kind, guid, location, functions, logging_on);
        }
    };
    (@functions $module:ident $interface:ident $($name:ident($($argument:ident: $type:ty),* $(,)?) -> $result:ty = $call:expr;)*) => {
        /// The functions of `fmi2Functions.h`.
        pub mod $module {
            use super::*;
            use $crate::ctypes::*;
            use $crate::$interface::*;
            $(
                #[doc = concat!("`", stringify!($name), "` of FMI 2.0.")]
                ///
                /// # Safety
                /// The arguments are as FMI 2.0 asks for.
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn $name($($argument: $type),*) -> $result {
                    unsafe { $call }
                }
            )*
        }
    };
}

/// Exports what FMI 2.0 for model exchange has besides, of a [`Slave`](crate::Slave) whose equations are
/// [`Continuous`](crate::Continuous): once per dynamic library, beside [`export!`](crate::export).
#[macro_export]
macro_rules! export_exchange {
    ($slave:ty) => {
        $crate::export! { @functions exchange_functions exchange_interface
            fmi2EnterEventMode(c: Component) -> Status = enter_event_mode::<$slave>(c);
            fmi2NewDiscreteStates(c: Component, info: *mut EventInfo) -> Status
                = new_discrete_states::<$slave>(c, info);
            fmi2EnterContinuousTimeMode(c: Component) -> Status = enter_continuous_time_mode::<$slave>(c);
            fmi2CompletedIntegratorStep(c: Component, _no_set_state_prior: Boolean, event: *mut Boolean,
                ends: *mut Boolean) -> Status
                = completed_integrator_step::<$slave>(c, event, ends);
            fmi2SetTime(c: Component, time: Real) -> Status = set_time::<$slave>(c, time);
            fmi2SetContinuousStates(c: Component, x: *const Real, n: usize) -> Status
                = set_continuous_states::<$slave>(c, x, n);
            fmi2GetDerivatives(c: Component, dx: *mut Real, n: usize) -> Status = get_derivatives::<$slave>(c, dx, n);
            fmi2GetEventIndicators(c: Component, _z: *mut Real, n: usize) -> Status
                = get_event_indicators::<$slave>(c, n);
            fmi2GetContinuousStates(c: Component, x: *mut Real, n: usize) -> Status
                = get_continuous_states::<$slave>(c, x, n);
            fmi2GetNominalsOfContinuousStates(c: Component, x: *mut Real, n: usize) -> Status
                = get_nominals::<$slave>(c, x, n);
        }
    };
}
