//! How a run ended. The verdict function lives in `truth-model`; this is only its alphabet.

use serde::{Deserialize, Serialize};

/// Coded as a Float64 output because many FMI importers read every output as a real.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Outcome {
    /// Not decided yet.
    #[default]
    InFlight = 0,
    /// At rest, upright, where it touched down.
    Landed = 1,
    /// Upright, but it slid farther than the scenario's limit or was not seen at rest.
    Slid = 2,
    /// The centre of mass left the support polygon and did not come back.
    Tipped = 3,
    /// Upright, but the hull or the nozzle touched the ground.
    Struck = 4,
    /// An impact above the speed that the scenario calls survivable.
    Crashed = 5,
    /// The run ended without a touchdown.
    NoContact = 6,
    /// Upright and nothing but feet touched, but a strut used up its stroke.
    Bottomed = 7,
}

impl Outcome {
    pub const ALL: [Self; 8] = [
        Self::InFlight,
        Self::Landed,
        Self::Slid,
        Self::Tipped,
        Self::Struck,
        Self::Crashed,
        Self::NoContact,
        Self::Bottomed,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::InFlight => "in_flight",
            Self::Landed => "landed",
            Self::Slid => "slid",
            Self::Tipped => "tipped",
            Self::Struck => "struck",
            Self::Crashed => "crashed",
            Self::NoContact => "no_contact",
            Self::Bottomed => "bottomed",
        }
    }

    pub fn code(self) -> f64 {
        f64::from(self as u8)
    }

    pub fn from_code(code: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|outcome| outcome.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip() {
        for outcome in Outcome::ALL {
            assert_eq!(Outcome::from_code(outcome.code()), Some(outcome));
        }
        assert_eq!(Outcome::from_code(0.5), None);
    }
}
