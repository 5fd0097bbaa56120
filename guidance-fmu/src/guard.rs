//! Refuses inputs that no landing has, by name, before anything is computed from them.

use lander_models::ModelError;
use lander_models::signals::GUIDANCE;

/// Checks the flat input slice, in table order.
///
/// # Errors
/// The first scalar that is not finite or outside its range (`lander_models::signals`).
pub fn check(inputs: &[f64]) -> Result<(), ModelError> {
    let mut values = inputs.iter();
    for signal in GUIDANCE.inputs {
        let range = signal.range();
        for (index, &value) in values.by_ref().take(signal.size).enumerate() {
            let name = || signal.scalar_name(index);
            if !value.is_finite() {
                return Err(ModelError::NonFiniteInput { name: name(), value });
            }
            if !range.contains(&value) {
                let (low, high) = (*range.start(), *range.end());
                return Err(ModelError::AbsurdInput { name: name(), value, low, high });
            }
        }
    }
    Ok(())
}
