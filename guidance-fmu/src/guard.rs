//! Refuses inputs that no landing has, by name, before anything is computed from them.

use lander_models::ModelError;
use lander_models::signals::{
    ALTIMETER_M, GUIDANCE, MASS_KG, POSITION_W, RATE_B, SPECIFIC_FORCE_B, VELOCITY_W,
};

/// Magnitudes that a landing never reaches: a broken wire or a wrong unit, not a disturbance. Ten
/// times what the planner's envelope, the fastest tumble and the hardest blow would give.
const LIMITS: [(&str, f64); 6] = [
    (POSITION_W.name, 1e6),
    (VELOCITY_W.name, 1e4),
    (RATE_B.name, 1e2),
    (SPECIFIC_FORCE_B.name, 1e5),
    (MASS_KG.name, 1e6),
    (ALTIMETER_M.name, 1e6),
];

/// Checks the flat input slice, in table order.
///
/// # Errors
/// The first scalar that is not finite or beyond its limit, or a negative mass.
pub fn check(inputs: &[f64]) -> Result<(), ModelError> {
    let mut values = inputs.iter();
    for signal in GUIDANCE.inputs {
        let limit = LIMITS.iter().find(|(name, _)| *name == signal.name).map(|(_, limit)| *limit);
        for (index, &value) in values.by_ref().take(signal.size).enumerate() {
            if !value.is_finite() {
                return Err(ModelError::NonFiniteInput { name: signal.scalar_name(index), value });
            }
            let (low, high) = match limit {
                Some(limit) if signal.name == MASS_KG.name => (0.0, limit),
                Some(limit) => (-limit, limit),
                None => continue,
            };
            if !(low..=high).contains(&value) {
                let name = signal.scalar_name(index);
                return Err(ModelError::AbsurdInput { name, value, low, high });
            }
        }
    }
    Ok(())
}
