//! The ten C functions of model exchange, for any slave; [`crate::export_exchange!`] gives them their names.
//!
//! # Safety
//! As [`crate::interface`].

use crate::calls::Call;
use crate::ctypes::*;
use crate::instance::{CallError, Instance};
use crate::interface::{run, slice, slice_mut, target};
use crate::slave::Slave;

pub unsafe fn enter_event_mode<S: Slave>(c: Component) -> Status {
    unsafe {
        run::<S>(c, Call::EnterEventMode, |instance| {
            instance.enter_event_mode();
            Ok(())
        })
    }
}

pub unsafe fn new_discrete_states<S: Slave>(c: Component, info: *mut EventInfo) -> Status {
    unsafe {
        run::<S>(c, Call::NewDiscreteStates, |instance| {
            *target(info, "eventInfo")? = instance.new_discrete_states()?;
            Ok(())
        })
    }
}

pub unsafe fn enter_continuous_time_mode<S: Slave>(c: Component) -> Status {
    unsafe {
        run::<S>(c, Call::EnterContinuousTimeMode, |instance| {
            instance.enter_continuous_time_mode();
            Ok(())
        })
    }
}

/// No step ends in an event: those that there are, are known in advance.
pub unsafe fn completed_integrator_step<S: Slave>(c: Component, event: *mut Boolean, ends: *mut Boolean) -> Status {
    unsafe {
        run::<S>(c, Call::CompletedIntegratorStep, |_| {
            (*target(event, "enterEventMode")?, *target(ends, "terminateSimulation")?) = (0, 0);
            Ok(())
        })
    }
}

pub unsafe fn set_time<S: Slave>(c: Component, time: Real) -> Status {
    unsafe { run::<S>(c, Call::SetTime, |instance| instance.set_time(time)) }
}

pub unsafe fn set_continuous_states<S: Slave>(c: Component, states: *const Real, count: usize) -> Status {
    unsafe { run::<S>(c, Call::SetContinuousStates, |instance| instance.set_states(slice(states, count, "x")?)) }
}

/// Reads numbers of the equations into the host's room.
unsafe fn read<S: Slave>(
    c: Component,
    out: *mut Real,
    count: usize,
    body: impl FnOnce(&mut Instance<S>, &mut [f64]) -> Result<(), CallError>,
) -> Status {
    unsafe {
        run::<S>(c, Call::GetContinuous, |instance| {
            instance.refresh()?;
            body(instance, slice_mut(out, count, "x")?)
        })
    }
}

pub unsafe fn get_derivatives<S: Slave>(c: Component, out: *mut Real, count: usize) -> Status {
    unsafe { read::<S>(c, out, count, Instance::derivatives_into) }
}

pub unsafe fn get_event_indicators<S: Slave>(c: Component, count: usize) -> Status {
    unsafe { run::<S>(c, Call::GetContinuous, |instance| instance.check_indicators(count)) }
}

pub unsafe fn get_continuous_states<S: Slave>(c: Component, out: *mut Real, count: usize) -> Status {
    unsafe { read::<S>(c, out, count, Instance::states_into) }
}

pub unsafe fn get_nominals<S: Slave>(c: Component, out: *mut Real, count: usize) -> Status {
    unsafe { read::<S>(c, out, count, Instance::nominals_into) }
}
