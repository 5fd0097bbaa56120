//! YUNT V0: throttle, dead zone, start and tail-off, gimbal with rate limit, mass flow (T.4 to
//! T.7, T.60 to T.62).

use lander_models::Ticks;
use lander_models::scenario::Ignition;
use lander_models::vehicle::{DeadZone, Engine, G0_M_S2};
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::random;

/// Where the engine is between off and steady (T.61).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Off, or tailing off.
    #[default]
    Off,
    /// Valves open, no thrust for so many ticks more.
    Igniting(Ticks),
    /// Rising for the first time.
    Starting,
    /// Follows the throttle.
    Running,
}

/// Share of the thrust floor at which the start is over.
const STARTED_SHARE: f64 = 0.9;

/// Time for which unstable combustion stays lit or out: short against the vehicle's motion, long
/// against the chamber's filling.
const FLICKER: Ticks = Ticks(50);

impl Phase {
    /// Phase of the next tick, for a thrust asked of the valves; 0 is off.
    pub fn next(self, engine: &Engine, asked_n: f64, thrust_n: f64) -> Self {
        if asked_n <= 0.0 {
            return Self::Off;
        }
        match self {
            Self::Off if engine.ignition_delay > Ticks::ZERO => {
                Self::Igniting(engine.ignition_delay)
            }
            Self::Igniting(Ticks(left)) if left > 1 => Self::Igniting(Ticks(left - 1)),
            Self::Off | Self::Igniting(_) => Self::Starting,
            Self::Starting if thrust_n >= STARTED_SHARE * engine.thrust_min_n.min(asked_n) => {
                Self::Running
            }
            same => same,
        }
    }

    /// Lag with which thrust follows, s.
    fn lag_s(self, engine: &Engine) -> f64 {
        match self {
            Self::Off | Self::Igniting(_) => engine.tail_off_lag_s,
            Self::Starting => engine.ignition_lag_s,
            Self::Running => engine.thrust_lag_s,
        }
    }

    /// Whether there is fire in the chamber.
    pub fn burns(self) -> bool {
        matches!(self, Self::Starting | Self::Running)
    }
}

/// Thrust that the valves are set for by a command held, N; 0 is closed (T.60).
///
/// In the dead zone combustion is not sustained: closed, or open for what was asked if the engine
/// is one that flickers; between the dead zone and the floor the throttle stop holds it at the
/// floor.
pub fn thrust_asked_n(engine: &Engine, ignition: Ignition, command_n: f64) -> f64 {
    if ignition == Ignition::Never || command_n <= 0.0 {
        0.0
    } else if in_dead_zone(engine, command_n) {
        match engine.dead_zone {
            DeadZone::Off => 0.0,
            DeadZone::Unstable => command_n,
        }
    } else {
        let command_n = command_n.clamp(engine.thrust_min_n, engine.thrust_max_n);
        engine.throttle.as_ref().map_or(command_n, |throttle| throttle.at(command_n))
    }
}

/// Whether combustion that a dead-zone command cannot sustain is lit now: for a share
/// command/limit of the time (T.62).
pub fn is_lit(engine: &Engine, command_n: f64, seed: u64, now: Ticks) -> bool {
    random::uniform(seed, "dead zone", now.0 / FLICKER.0) < command_n / engine.dead_zone_n
}

/// Whether a command asks for thrust that the engine cannot sustain.
pub fn in_dead_zone(engine: &Engine, command_n: f64) -> bool {
    command_n > 0.0 && command_n < engine.dead_zone_n
}

/// Gimbal angles within the mechanical limit, each axis by itself.
pub fn gimbal_target_rad(engine: &Engine, command_rad: Vector2<f64>) -> Vector2<f64> {
    command_rad.map(|angle| angle.clamp(-engine.gimbal_limit_rad, engine.gimbal_limit_rad))
}

/// Thrust and gimbal angles before errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuators {
    pub thrust_n: f64,
    pub gimbal_rad: Vector2<f64>,
}

/// How actuators follow held targets through a given time, exactly (T.5, T.6): an integrator would
/// lose its order at the corner between lag and rate limit.
#[derive(Clone, Copy, Debug)]
pub struct Following<'a> {
    engine: &'a Engine,
    target: Actuators,
    time_s: f64,
    /// What is left of a distance to the target after that time.
    thrust_left: f64,
    gimbal_left: f64,
}

impl<'a> Following<'a> {
    pub fn through(engine: &'a Engine, phase: Phase, target: Actuators, time_s: f64) -> Self {
        let thrust_left = libm::exp(-time_s / phase.lag_s(engine));
        let gimbal_left = libm::exp(-time_s / engine.gimbal_lag_s);
        Self { engine, target, time_s, thrust_left, gimbal_left }
    }

    /// Where actuators are that time after `from`.
    #[inline]
    pub fn after(&self, from: Actuators) -> Actuators {
        let target = &self.target;
        Actuators {
            thrust_n: target.thrust_n + (from.thrust_n - target.thrust_n) * self.thrust_left,
            gimbal_rad: from.gimbal_rad.zip_map(&target.gimbal_rad, |angle_rad, target_rad| {
                self.gimbal_after_rad(angle_rad, target_rad)
            }),
        }
    }

    /// First-order lag within the rate limit.
    fn gimbal_after_rad(&self, angle_rad: f64, target_rad: f64) -> f64 {
        let (rate_rad_s, lag_s) = (self.engine.gimbal_rate_rad_s, self.engine.gimbal_lag_s);
        let error_rad = target_rad - angle_rad;
        // Beyond this error the lag asks for more than the rate limit.
        let limited_rad = (error_rad.abs() - rate_rad_s * lag_s).max(0.0);
        if limited_rad == 0.0 {
            return target_rad - error_rad * self.gimbal_left;
        }
        let limited_s = limited_rad / rate_rad_s;
        if self.time_s < limited_s {
            return angle_rad + error_rad.signum() * rate_rad_s * self.time_s;
        }
        let left_rad = error_rad - error_rad.signum() * limited_rad;
        target_rad - left_rad * libm::exp(-(self.time_s - limited_s) / lag_s)
    }
}

/// Unit thrust direction, body frame: body z turned about x, then about y (T.4).
#[inline]
pub fn thrust_direction_b(gimbal_rad: Vector2<f64>) -> Vector3<f64> {
    let ((sin_x, cos_x), (sin_y, cos_y)) = (libm::sincos(gimbal_rad.x), libm::sincos(gimbal_rad.y));
    Vector3::new(cos_x * sin_y, -sin_x, cos_x * cos_y)
}

/// Specific impulse at a thrust, s: constant, or by throttle.
#[inline]
pub fn isp_s(engine: &Engine, thrust_n: f64) -> f64 {
    let by_throttle = engine.isp_by_throttle.as_ref();
    by_throttle.map_or(engine.isp_s, |isp| isp.at(thrust_n / engine.thrust_max_n))
}

/// Propellant flow of a thruster, kg/s (T.7).
pub fn flow_kg_s(thrust_n: f64, isp_s: f64) -> f64 {
    thrust_n / (isp_s * G0_M_S2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yunt() -> Engine {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
        lander_models::Vehicle::load(file.as_ref()).unwrap().engine
    }

    #[test]
    fn commands_map_onto_the_throttle_range() {
        let target = |command| thrust_asked_n(&yunt(), Ignition::Nominal, command);
        for (command, thrust) in [
            (-5.0, 0.0),
            (0.0, 0.0),
            (599.9, 0.0),
            (600.0, 800.0),
            (800.0, 800.0),
            (3000.0, 3000.0),
            (9000.0, 5200.0),
        ] {
            assert_eq!(target(command), thrust, "command {command} N");
        }
        assert_eq!(thrust_asked_n(&yunt(), Ignition::Never, 3000.0), 0.0);
    }

    #[test]
    fn actuators_follow_their_differential_equations() {
        let engine = yunt();
        let (rate, lag_s) = (engine.gimbal_rate_rad_s, engine.gimbal_lag_s);
        let (start, target) = (Vector2::new(-0.1, 0.001), Vector2::new(0.1, 0.004));
        let from = |gimbal_rad| Actuators { thrust_n: 0.0, gimbal_rad };
        let to = Actuators { thrust_n: 1000.0, ..from(target) };
        let after = |t| Following::through(&engine, Phase::Running, to, t).after(from(start));
        let at = |t| after(t).gimbal_rad;
        for n in 0..700 {
            let (t, h) = (1e-3 * f64::from(n), 1e-6);
            let slope = (at(t + h) - at(t)) / h;
            let expected = ((target - at(t)) / lag_s).map(|r| r.clamp(-rate, rate));
            // A forward difference errs by h/2 times the second derivative, rate/lag = 7 rad/s².
            assert!((slope - expected).norm() < 1e-5, "t = {t} s: {slope} is not {expected}");
        }
        let thrust_n = after(engine.thrust_lag_s).thrust_n;
        assert!((thrust_n - 1000.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
    }

    #[test]
    fn a_positive_gimbal_angle_turns_the_thrust_the_way_its_axis_says() {
        let about_x = thrust_direction_b(Vector2::new(0.1, 0.0));
        assert!(about_x.y < 0.0 && about_x.x == 0.0);
        let about_y = thrust_direction_b(Vector2::new(0.0, 0.1));
        assert!(about_y.x > 0.0 && about_y.y == 0.0);
    }
}
