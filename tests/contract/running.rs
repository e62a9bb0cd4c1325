//! Stepping an identifier while every output is watched.

use switchid::identify::{Identifier, Outputs, Sample};
use switchid::law::Term;

/// Every output, bit by bit.
pub type Bits = Vec<u64>;

/// Every output of the identifier.
///
/// # Panics
/// Where one of them is no finite number.
pub fn outputs(identifier: &Identifier) -> Bits {
    let terms: Vec<Term> = identifier.coefficients().iter().map(|coefficient| coefficient.term).collect();
    let values: Vec<f64> = Outputs::new(&terms, identifier).values(identifier).map(|value| value.number()).collect();
    if let Some(place) = values.iter().position(|value| !value.is_finite()) {
        panic!("{} = {}: {:?}", Outputs::describe(&terms)[place].name, values[place], identifier.output());
    }
    values.into_iter().map(f64::to_bits).collect()
}

/// The outputs after each sample; a sample that is skipped repeats the outputs before it.
pub fn go_on(identifier: &mut Identifier, samples: &[Sample]) -> Vec<Bits> {
    let step = |sample: &Sample| {
        let _ = identifier.step(*sample);
        outputs(identifier)
    };
    samples.iter().map(step).collect()
}

/// The whole state.
pub fn bytes(identifier: &Identifier) -> Vec<u8> {
    postcard::to_stdvec(identifier).unwrap()
}

/// The identifier that was in this state.
pub fn restored(bytes: &[u8]) -> Identifier {
    postcard::from_bytes(bytes).unwrap()
}
