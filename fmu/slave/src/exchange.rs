//! An instance that a host integrates: model exchange (FMI 2.0, chapter 3).

use crate::calls::Phase;
use crate::ctypes::{Boolean, EventInfo};
use crate::instance::{CallError, Instance};
use crate::slave::{Continuous, Slave};

impl<S: Slave> Instance<S> {
    fn continuous(&mut self) -> Result<&mut dyn Continuous, CallError> {
        let what = "model exchange with this instance, which is for co-simulation,";
        self.state.slave.continuous().ok_or(CallError::NotOffered { what })
    }

    /// `fmi2EnterEventMode`.
    pub fn enter_event_mode(&mut self) {
        self.state.phase = Phase::Event;
    }

    /// `fmi2EnterContinuousTimeMode`.
    pub fn enter_continuous_time_mode(&mut self) {
        self.state.phase = Phase::Continuous;
    }

    /// `fmi2NewDiscreteStates`: nothing is left to iterate after it.
    ///
    /// # Errors
    /// [`CallError::NotOffered`].
    pub fn new_discrete_states(&mut self) -> Result<EventInfo, CallError> {
        self.continuous()?;
        let (slave, values) = (&mut self.state.slave, &self.state.values);
        let next = slave.continuous().and_then(|continuous| continuous.settle(values, &mut self.log));
        let next_event_time_defined = Boolean::from(next.is_some());
        Ok(EventInfo { next_event_time_defined, next_event_time: next.unwrap_or_default(), ..EventInfo::default() })
    }

    /// `fmi2SetTime`. A solver looks beyond the stop time, and back.
    ///
    /// # Errors
    /// [`CallError::Time`], [`CallError::NotOffered`].
    pub fn set_time(&mut self, time: f64) -> Result<(), CallError> {
        if !time.is_finite() {
            return Err(CallError::Time { time });
        }
        self.continuous()?.set_time(time);
        self.show_time(time);
        Ok(())
    }

    /// `fmi2SetContinuousStates`.
    ///
    /// # Errors
    /// [`CallError::StateCount`], [`CallError::NotFinite`], [`CallError::NotOffered`].
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), CallError> {
        let continuous = self.continuous()?;
        fits(states.len(), continuous.states().len())?;
        if let Some(place) = states.iter().position(|value| !value.is_finite()) {
            return Err(CallError::NotFinite { number: place + 1, value: states[place] });
        }
        continuous.set_states(states);
        Ok(())
    }

    /// `fmi2GetContinuousStates`.
    ///
    /// # Errors
    /// [`CallError::StateCount`], [`CallError::NotOffered`].
    pub fn states_into(&mut self, room: &mut [f64]) -> Result<(), CallError> {
        let states = self.continuous()?.states();
        fill(room, &states)
    }

    /// `fmi2GetDerivatives`.
    ///
    /// # Errors
    /// [`CallError::StateCount`], [`CallError::NotOffered`].
    pub fn derivatives_into(&mut self, room: &mut [f64]) -> Result<(), CallError> {
        self.continuous()?;
        let (slave, values) = (&mut self.state.slave, &self.state.values);
        let derivatives = slave.continuous().map(|continuous| continuous.derivatives(values));
        fill(room, &derivatives.unwrap_or_default())
    }

    /// `fmi2GetEventIndicators`: every event is known in advance, so that there are none.
    ///
    /// # Errors
    /// [`CallError::NotOffered`].
    pub fn check_indicators(&mut self, count: usize) -> Result<(), CallError> {
        self.continuous()?;
        if count == 0 { Ok(()) } else { Err(CallError::NotOffered { what: "an event indicator" }) }
    }

    /// `fmi2GetNominalsOfContinuousStates`: 1, since the law may be in any units.
    ///
    /// # Errors
    /// [`CallError::StateCount`], [`CallError::NotOffered`].
    pub fn nominals_into(&mut self, room: &mut [f64]) -> Result<(), CallError> {
        let count = self.continuous()?.states().len();
        fill(room, &vec![1.0; count])
    }
}

fn fits(given: usize, needed: usize) -> Result<(), CallError> {
    if given == needed { Ok(()) } else { Err(CallError::StateCount { given, needed }) }
}

fn fill(room: &mut [f64], values: &[f64]) -> Result<(), CallError> {
    fits(room.len(), values.len())?;
    room.copy_from_slice(values);
    Ok(())
}
