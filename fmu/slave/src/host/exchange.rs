//! Model exchange with an instance.

use super::{ExchangeFunctions, Instance, ok};
use crate::ctypes::{Component, EventInfo, Real, Status};

/// An instance that the host integrates.
#[derive(Clone, Copy)]
pub struct Exchange<'a> {
    /// The instance.
    pub instance: &'a Instance,
    /// What it has for model exchange.
    pub functions: ExchangeFunctions,
}

impl Exchange<'_> {
    /// Any call, as [`Instance::call`].
    pub fn call<T>(&self, call: impl FnOnce(&ExchangeFunctions, Component) -> T) -> T {
        call(&self.functions, self.instance.component)
    }

    /// `fmi2EnterEventMode`.
    pub fn enter_event_mode(&self) -> Status {
        // SAFETY: the component is alive, here and in all calls below.
        self.call(|f, c| unsafe { (f.enter_event_mode)(c) })
    }

    /// `fmi2NewDiscreteStates`; when the next event is, where one is known.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn new_discrete_states(&self) -> Result<Option<Real>, Status> {
        let mut info = EventInfo::default();
        ok(self.call(|f, c| unsafe { (f.new_discrete_states)(c, &mut info) }), ())?;
        Ok((info.next_event_time_defined != 0).then_some(info.next_event_time))
    }

    /// `fmi2EnterContinuousTimeMode`.
    pub fn enter_continuous_time_mode(&self) -> Status {
        self.call(|f, c| unsafe { (f.enter_continuous_time_mode)(c) })
    }

    /// `fmi2CompletedIntegratorStep`; whether it asks for an event or for the end.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn completed_integrator_step(&self) -> Result<bool, Status> {
        let (mut event, mut end) = (0, 0);
        ok(self.call(|f, c| unsafe { (f.completed_integrator_step)(c, 1, &mut event, &mut end) }), ())?;
        Ok(event != 0 || end != 0)
    }

    /// `fmi2SetTime`.
    pub fn set_time(&self, time: Real) -> Status {
        self.call(|f, c| unsafe { (f.set_time)(c, time) })
    }

    /// `fmi2SetContinuousStates`.
    pub fn set_states(&self, states: &[Real]) -> Status {
        self.call(|f, c| unsafe { (f.set_states)(c, states.as_ptr(), states.len()) })
    }

    /// `fmi2GetContinuousStates`, that many.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn states(&self, count: usize) -> Result<Vec<Real>, Status> {
        let mut states = vec![f64::NAN; count];
        let out = states.as_mut_ptr();
        ok(self.call(|f, c| unsafe { (f.states)(c, out, count) }), states)
    }

    /// `fmi2GetDerivatives`, that many.
    ///
    /// # Errors
    /// The status that is not OK.
    pub fn derivatives(&self, count: usize) -> Result<Vec<Real>, Status> {
        let mut derivatives = vec![f64::NAN; count];
        let out = derivatives.as_mut_ptr();
        ok(self.call(|f, c| unsafe { (f.derivatives)(c, out, count) }), derivatives)
    }
}
