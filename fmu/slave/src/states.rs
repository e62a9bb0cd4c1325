//! The states that a host holds, each behind a handle that is compared and never followed.
//!
//! A handle is the address of the state, so that no two living ones are the same; one that was freed, that another
//! instance gave out, or that is no handle at all is simply not found.

/// One state, with its bytes between `fmi2SerializedFMUstateSize` and `fmi2SerializeFMUstate`.
struct Held<T> {
    state: Box<T>,
    packed: Option<Vec<u8>>,
}

impl<T> Held<T> {
    fn handle(&self) -> usize {
        (&raw const *self.state).addr()
    }
}

/// The states of one instance.
pub struct States<T>(Vec<Held<T>>);

impl<T> States<T> {
    /// None.
    pub const fn new() -> States<T> {
        States(Vec::new())
    }

    /// Keeps a state under the handle given, where that is one of ours, else under a new one; the handle.
    pub fn keep(&mut self, handle: usize, state: T) -> usize {
        if let Some(held) = self.find(handle) {
            *held.state = state;
            held.packed = None;
            return handle;
        }
        let held = Held { state: Box::new(state), packed: None };
        let handle = held.handle();
        self.0.push(held);
        handle
    }

    /// The state of that handle.
    pub fn get(&self, handle: usize) -> Option<&T> {
        self.0.iter().find(|held| held.handle() == handle).map(|held| &*held.state)
    }

    /// The bytes of that state; `pack` makes them once for the host's two questions.
    ///
    /// # Errors
    /// What `pack` says.
    pub fn packed<E>(
        &mut self,
        handle: usize,
        pack: impl FnOnce(&T) -> Result<Vec<u8>, E>,
    ) -> Option<Result<&mut Option<Vec<u8>>, E>> {
        let held = self.find(handle)?;
        if held.packed.is_none() {
            match pack(&held.state) {
                Ok(bytes) => held.packed = Some(bytes),
                Err(error) => return Some(Err(error)),
            }
        }
        Some(Ok(&mut held.packed))
    }

    /// Frees the state of that handle; whether there was one.
    pub fn free(&mut self, handle: usize) -> bool {
        let place = self.0.iter().position(|held| held.handle() == handle);
        place.map(|place| self.0.swap_remove(place)).is_some()
    }

    fn find(&mut self, handle: usize) -> Option<&mut Held<T>> {
        self.0.iter_mut().find(|held| held.handle() == handle)
    }
}

#[cfg(test)]
mod tests {
    use super::States;

    #[test]
    fn only_living_handles_are_found() {
        let mut states = States::new();
        let (one, two) = (states.keep(0, "one"), states.keep(12345, "two"));
        assert_ne!(one, two);
        assert_eq!((states.get(one), states.get(two), states.get(0)), (Some(&"one"), Some(&"two"), None));
        assert_eq!(states.keep(one, "three"), one);
        assert_eq!(states.get(one), Some(&"three"));
        assert!(states.free(one) && !states.free(one));
        assert_eq!((states.get(one), states.get(two)), (None, Some(&"two")));
    }

    #[test]
    fn a_state_that_is_overwritten_is_packed_anew() {
        let mut states = States::new();
        let handle = states.keep(0, 3_u8);
        let pack = |state: &u8| Ok::<_, ()>(vec![*state]);
        assert_eq!(states.packed(handle, pack).unwrap().unwrap().as_deref(), Some(&[3][..]));
        states.keep(handle, 4);
        assert_eq!(states.packed(handle, pack).unwrap().unwrap().as_deref(), Some(&[4][..]));
        assert!(states.packed(handle + 1, pack).is_none());
    }
}
