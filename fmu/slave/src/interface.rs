//! The 34 C functions that every FMU has, for any slave; [`crate::export!`] gives them their names.
//!
//! # Safety
//! All of them trust the host as far as FMI 2.0 asks for: a component is one that `fmi2Instantiate` returned and that
//! was not freed, arrays are as long as said, texts end with a zero byte. Null pointers are refused, and so are states
//! that the instance does not hold: a state's handle is never followed. No panic leaves them.

use crate::calls::Call;
use crate::creation::{Request, read};
use crate::ctypes::*;
use crate::instance::{CallError, Instance};
use crate::log::{Category, Log, c_text};
use crate::slave::Slave;
use crate::values::Value;
use std::any::Any;
use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a call on an instance: refused calls are logged, panics end here.
pub(crate) unsafe fn run<S: Slave>(
    component: Component,
    call: Call,
    body: impl FnOnce(&mut Instance<S>) -> Result<(), CallError>,
) -> Status {
    // SAFETY: see the module.
    let Some(instance) = (unsafe { component.cast::<Instance<S>>().as_mut() }) else { return ERROR };
    let outcome = catch_unwind(AssertUnwindSafe(|| instance.permit(call).and_then(|()| body(instance))));
    match outcome {
        Ok(Ok(())) => OK,
        Ok(Err(error)) => {
            instance.complain(&error);
            ERROR
        }
        Err(panic) => {
            instance.fail(panic_text(panic.as_ref()));
            ERROR
        }
    }
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message")
}

/// The array as a slice; empty where its length is 0, whatever the pointer.
pub(crate) unsafe fn slice<'a, T>(start: *const T, length: usize, what: &'static str) -> Result<&'a [T], CallError> {
    match (start.is_null(), length) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(CallError::Null { what }),
        // SAFETY: see the module.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(start, length) }),
    }
}

pub(crate) unsafe fn slice_mut<'a, T>(
    start: *mut T,
    length: usize,
    what: &'static str,
) -> Result<&'a mut [T], CallError> {
    match (start.is_null(), length) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(CallError::Null { what }),
        // SAFETY: see the module.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(start, length) }),
    }
}

pub(crate) unsafe fn target<'a, T>(pointer: *mut T, what: &'static str) -> Result<&'a mut T, CallError> {
    // SAFETY: see the module.
    unsafe { pointer.as_mut() }.ok_or(CallError::Null { what })
}

unsafe fn bytes<'a>(text: Text) -> Option<&'a [u8]> {
    // SAFETY: see the module.
    if text.is_null() { None } else { Some(unsafe { CStr::from_ptr(text) }.to_bytes()) }
}

unsafe fn text(pointer: Text, what: &'static str) -> Result<String, CallError> {
    // SAFETY: see the module.
    let found = unsafe { bytes(pointer) };
    found.map(|text| String::from_utf8_lossy(text).into_owned()).ok_or(CallError::Null { what })
}

unsafe fn texts(start: *const Text, length: usize, what: &'static str) -> Result<Vec<String>, CallError> {
    // SAFETY: see the module.
    unsafe { slice(start, length, what)?.iter().map(|pointer| text(*pointer, what)).collect() }
}

pub unsafe fn types_platform() -> Text {
    c"default".as_ptr()
}

pub unsafe fn version() -> Text {
    c"2.0".as_ptr()
}

pub unsafe fn set_debug_logging<S: Slave>(c: Component, on: Boolean, count: usize, names: *const Text) -> Status {
    unsafe {
        run::<S>(c, Call::SetDebugLogging, |instance| {
            let names = texts(names, count, "categories")?;
            instance.log.enable(on != 0, &names);
            Ok(())
        })
    }
}

pub unsafe fn instantiate<S: Slave>(
    name: Text,
    fmu_type: FmuType,
    guid: Text,
    location: Text,
    functions: *const CallbackFunctions,
    logging_on: Boolean,
) -> Component {
    // SAFETY: see the module.
    let (Some(callbacks), name) = (unsafe { functions.as_ref() }, unsafe { bytes(name) }) else {
        return std::ptr::null_mut();
    };
    let name = c_text(&String::from_utf8_lossy(name.unwrap_or(b"unnamed")));
    let guid = unsafe { bytes(guid) }.map(String::from_utf8_lossy).unwrap_or_default();
    let location = unsafe { bytes(location) };
    let request = Request { kind: fmu_type, guid: &guid, location };
    let log = Log::new(*callbacks, name, logging_on != 0);
    match catch_unwind(AssertUnwindSafe(|| read::<S>(&request))) {
        Ok(Ok((interface, slave))) => {
            let instance = Instance::new(interface, slave, log, fmu_type == MODEL_EXCHANGE);
            Box::into_raw(Box::new(instance)).cast()
        }
        Ok(Err(error)) => refuse(&log, &error.to_string()),
        Err(panic) => refuse(&log, panic_text(panic.as_ref())),
    }
}

fn refuse(log: &Log, why: &str) -> Component {
    log.say(Category::Error, why);
    std::ptr::null_mut()
}

pub unsafe fn free_instance<S: Slave>(component: Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: see the module. What a panic on the way would leave behind cannot be mended: it is dropped unsaid.
    let freed = catch_unwind(AssertUnwindSafe(|| drop(unsafe { Box::from_raw(component.cast::<Instance<S>>()) })));
    drop(freed);
}

pub unsafe fn setup_experiment<S: Slave>(c: Component, start_time: Real, stop_time: Option<Real>) -> Status {
    unsafe { run::<S>(c, Call::SetupExperiment, |instance| instance.setup(start_time, stop_time)) }
}

pub unsafe fn enter_initialization_mode<S: Slave>(c: Component) -> Status {
    unsafe {
        run::<S>(c, Call::EnterInitializationMode, |instance| {
            instance.enter_initialization();
            Ok(())
        })
    }
}

pub unsafe fn exit_initialization_mode<S: Slave>(c: Component) -> Status {
    unsafe { run::<S>(c, Call::ExitInitializationMode, Instance::exit_initialization) }
}

pub unsafe fn terminate<S: Slave>(c: Component) -> Status {
    unsafe {
        run::<S>(c, Call::Terminate, |instance| {
            instance.terminate();
            Ok(())
        })
    }
}

pub unsafe fn reset<S: Slave>(c: Component) -> Status {
    unsafe {
        run::<S>(c, Call::Reset, |instance| {
            instance.reset();
            Ok(())
        })
    }
}

unsafe fn get<S: Slave, T>(
    c: Component,
    references: *const ValueReference,
    count: usize,
    out: *mut T,
    asked: &'static str,
    pick: impl Fn(&Value) -> Option<T>,
) -> Status {
    unsafe {
        run::<S>(c, Call::Get, |instance| {
            let out = slice_mut(out, count, "value")?;
            instance.refresh()?;
            for (reference, slot) in slice(references, count, "vr")?.iter().zip(out) {
                *slot = instance.get(*reference as usize, asked, &pick)?;
            }
            Ok(())
        })
    }
}

pub unsafe fn get_real<S: Slave>(c: Component, vr: *const ValueReference, n: usize, out: *mut Real) -> Status {
    let pick = |value: &Value| if let Value::Real(value) = value { Some(*value) } else { None };
    unsafe { get::<S, _>(c, vr, n, out, "Real", pick) }
}

pub unsafe fn get_integer<S: Slave>(c: Component, vr: *const ValueReference, n: usize, out: *mut Integer) -> Status {
    let pick = |value: &Value| if let Value::Integer(value) = value { Some(*value) } else { None };
    unsafe { get::<S, _>(c, vr, n, out, "Integer", pick) }
}

pub unsafe fn get_boolean<S: Slave>(c: Component, vr: *const ValueReference, n: usize, out: *mut Boolean) -> Status {
    let pick = |value: &Value| if let Value::Boolean(value) = value { Some(Boolean::from(*value)) } else { None };
    unsafe { get::<S, _>(c, vr, n, out, "Boolean", pick) }
}

pub unsafe fn get_string<S: Slave>(c: Component, vr: *const ValueReference, n: usize, out: *mut Text) -> Status {
    unsafe {
        run::<S>(c, Call::Get, |instance| {
            let out = slice_mut(out, n, "value")?;
            let pick = |value: &Value| if let Value::Text(value) = value { Some(c_text(value)) } else { None };
            let references = slice(vr, n, "vr")?.iter();
            let texts = references.map(|reference| instance.get(*reference as usize, "String", pick));
            instance.texts = texts.collect::<Result<Vec<CString>, _>>()?;
            for (text, slot) in instance.texts.iter().zip(out) {
                *slot = text.as_ptr();
            }
            Ok(())
        })
    }
}

unsafe fn set<S: Slave, T: Copy>(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *const T,
    wrap: impl Fn(T) -> Result<Value, CallError>,
) -> Status {
    unsafe {
        run::<S>(c, Call::Set, |instance| {
            let references = slice(references, count, "vr")?;
            let values = slice(values, count, "value")?;
            for (reference, value) in references.iter().zip(values) {
                instance.check_set(*reference as usize, &wrap(*value)?)?;
            }
            for (reference, value) in references.iter().zip(values) {
                instance.set(*reference as usize, wrap(*value)?);
            }
            Ok(())
        })
    }
}

pub unsafe fn set_real<S: Slave>(c: Component, vr: *const ValueReference, n: usize, values: *const Real) -> Status {
    unsafe { set::<S, _>(c, vr, n, values, |value| Ok(Value::Real(value))) }
}

pub unsafe fn set_integer<S: Slave>(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    values: *const Integer,
) -> Status {
    unsafe { set::<S, _>(c, vr, n, values, |value| Ok(Value::Integer(value))) }
}

pub unsafe fn set_boolean<S: Slave>(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    values: *const Boolean,
) -> Status {
    unsafe { set::<S, _>(c, vr, n, values, |value| Ok(Value::Boolean(value != 0))) }
}

pub unsafe fn set_string<S: Slave>(c: Component, vr: *const ValueReference, n: usize, values: *const Text) -> Status {
    unsafe { set::<S, _>(c, vr, n, values, |value| text(value, "value").map(Value::Text)) }
}

/// Runs a call with the handle in the host's slot, and puts the handle that it returns there.
unsafe fn with_slot<S: Slave>(
    c: Component,
    slot: *mut FmuState,
    body: impl FnOnce(&mut Instance<S>, usize) -> Result<usize, CallError>,
) -> Status {
    unsafe {
        run::<S>(c, Call::State, |instance| {
            let slot = target(slot, "FMUstate")?;
            *slot = std::ptr::without_provenance_mut(body(instance, slot.addr())?);
            Ok(())
        })
    }
}

pub unsafe fn get_fmu_state<S: Slave>(c: Component, state: *mut FmuState) -> Status {
    unsafe { with_slot::<S>(c, state, |instance, handle| Ok(instance.save(handle))) }
}

pub unsafe fn set_fmu_state<S: Slave>(c: Component, state: FmuState) -> Status {
    unsafe { run::<S>(c, Call::State, |instance| instance.restore(state.addr())) }
}

/// A null state is ignored, as the standard asks.
pub unsafe fn free_fmu_state<S: Slave>(c: Component, state: *mut FmuState) -> Status {
    if state.is_null() {
        return unsafe { run::<S>(c, Call::State, |_| Ok(())) };
    }
    let free = |instance: &mut Instance<S>, handle| match handle {
        0 => Ok(0),
        handle => instance.free(handle).map(|()| 0),
    };
    unsafe { with_slot::<S>(c, state, free) }
}

pub unsafe fn serialized_size<S: Slave>(c: Component, state: FmuState, size: *mut usize) -> Status {
    unsafe {
        run::<S>(c, Call::State, |instance| {
            *target(size, "size")? = instance.packed_size(state.addr())?;
            Ok(())
        })
    }
}

pub unsafe fn serialize<S: Slave>(c: Component, state: FmuState, out: *mut Byte, size: usize) -> Status {
    unsafe {
        run::<S>(c, Call::State, |instance| {
            instance.pack(state.addr(), slice_mut(out.cast::<u8>(), size, "serializedState")?)
        })
    }
}

pub unsafe fn deserialize<S: Slave>(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status {
    unsafe {
        with_slot::<S>(c, state, |instance, handle| {
            instance.unpack(slice(bytes.cast::<u8>(), size, "serializedState")?, handle)
        })
    }
}

pub unsafe fn get_directional_derivative<S: Slave>(c: Component) -> Status {
    unsafe { run::<S>(c, Call::GetDirectionalDerivative, |_| Ok(())) }
}

pub unsafe fn set_real_input_derivatives<S: Slave>(c: Component, count: usize) -> Status {
    unsafe { run::<S>(c, Call::SetRealInputDerivatives, |_| offered(count == 0, "interpolation of inputs")) }
}

pub unsafe fn get_real_output_derivatives<S: Slave>(c: Component, count: usize) -> Status {
    unsafe { run::<S>(c, Call::GetRealOutputDerivatives, |_| offered(count == 0, "a derivative of an output")) }
}

fn offered(offered: bool, what: &'static str) -> Result<(), CallError> {
    if offered { Ok(()) } else { Err(CallError::NotOffered { what }) }
}

pub unsafe fn do_step<S: Slave>(c: Component, time: Real, step: Real) -> Status {
    unsafe { run::<S>(c, Call::DoStep, |instance| instance.step(time, step)) }
}

pub unsafe fn cancel_step<S: Slave>(c: Component) -> Status {
    unsafe { run::<S>(c, Call::CancelStep, |_| Ok(())) }
}

unsafe fn status<S: Slave, T>(
    c: Component,
    out: *mut T,
    value: impl FnOnce(&mut Instance<S>) -> Option<T>,
    what: &'static str,
) -> Status {
    unsafe {
        run::<S>(c, Call::GetStatus, |instance| {
            *target(out, "value")? = value(instance).ok_or(CallError::NotOffered { what })?;
            Ok(())
        })
    }
}

pub unsafe fn get_status<S: Slave>(c: Component, kind: StatusKind, out: *mut Status) -> Status {
    unsafe { status::<S, _>(c, out, |_| (kind == DO_STEP_STATUS).then_some(OK), "this status") }
}

pub unsafe fn get_real_status<S: Slave>(c: Component, kind: StatusKind, out: *mut Real) -> Status {
    unsafe {
        status::<S, _>(c, out, |instance| (kind == LAST_SUCCESSFUL_TIME).then(|| instance.time()), "this real status")
    }
}

pub unsafe fn get_integer_status<S: Slave>(c: Component, out: *mut Integer) -> Status {
    unsafe { status::<S, _>(c, out, |_| None, "an integer status") }
}

pub unsafe fn get_boolean_status<S: Slave>(c: Component, kind: StatusKind, out: *mut Boolean) -> Status {
    unsafe { status::<S, _>(c, out, |_| (kind == TERMINATED).then_some(0), "this boolean status") }
}

pub unsafe fn get_string_status<S: Slave>(c: Component, kind: StatusKind, out: *mut Text) -> Status {
    unsafe { status::<S, _>(c, out, |_| (kind == PENDING_STATUS).then_some(c"".as_ptr()), "this string status") }
}
