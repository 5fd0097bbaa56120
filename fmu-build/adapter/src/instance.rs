//! One instance of a component, free of any FMI version: values, steps, states, and every check.

use std::collections::BTreeMap;
use std::ffi::CStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lander_models::time::{NotWholeTicks, TICK_S};
use lander_models::{Component, Settings, StepReport, Ticks};

use crate::error::Error;
use crate::guard;
use crate::lifecycle::{Call, Lifecycle};
use crate::logger::Logger;
use crate::snapshot::{Hash, NO_CONFIGURATION, Parameters, Snapshot, fingerprint};
use crate::variables::{
    CHANGES_NAME, DEFAULT_SCENARIO, SCENARIO_NAME, Variant, input_ranges, input_starts,
    interface_hash, token,
};

const NO_STOP: Ticks = Ticks(u64::MAX);

/// The constant part, shared by an instance and the states taken from it.
pub(crate) struct Config<C> {
    component: C,
    pub(crate) fingerprint: Hash,
}

pub struct Instance<C: Component> {
    pub(crate) logger: Logger,
    resources: Option<PathBuf>,
    pub(crate) variant: Variant,
    pub(crate) events: Events,
    pub(crate) interface: Hash,
    pub(crate) input_ranges: Vec<(f64, f64)>,
    /// Present from Initialization Mode on.
    pub(crate) config: Option<Arc<Config<C>>>,
    pub(crate) live: Snapshot<C::State>,
    /// Values of all outputs now.
    pub(crate) outputs: Vec<f64>,
    pub(crate) stored: BTreeMap<usize, StoredState<C>>,
}

/// What `GetFMUState` keeps.
pub(crate) struct StoredState<C: Component> {
    pub(crate) config: Option<Arc<Config<C>>>,
    pub(crate) snapshot: Snapshot<C::State>,
}

impl<C: Component> StoredState<C> {
    pub(crate) fn fingerprint(&self) -> Hash {
        self.config.as_ref().map_or(NO_CONFIGURATION, |config| config.fingerprint)
    }
}

/// What came of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    Done,
    /// Refused, and the importer may go on with other arguments.
    Discard,
    Error,
}

/// What a successful step tells the importer.
///
/// A run that ends within the step is over: unless steps may return early, `time_s` still is the
/// communication point at the end of the step, with the outputs with which the run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    pub time_s: f64,
    /// Before the end that was asked for.
    pub early: bool,
    pub report: StepReport,
}

/// What the importer makes of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Events {
    /// Nothing: steps are completed, and no event is reported.
    Unheard,
    /// It handles them at the ends of steps.
    AtStepEnd,
    /// A step ends with the tick of the event.
    ReturnEarly,
}

impl<C: Component> Instance<C> {
    /// An instance in state Instantiated, of that one of the `possible` variants whose token is
    /// `given`.
    pub fn new(
        possible: &[Variant],
        given: &str,
        resources: Option<PathBuf>,
        events: Events,
        logger: Logger,
    ) -> Result<Self, Error> {
        let fits = |variant: &&Variant| token(C::INTERFACE, **variant) == given;
        let Some(&variant) = possible.iter().find(fits) else {
            let expected = possible.iter().map(|variant| token(C::INTERFACE, *variant));
            let expected = expected.collect::<Vec<_>>().join("\" or \"");
            return Err(Error::Token { given: given.to_owned(), expected });
        };
        Ok(Self {
            logger,
            resources,
            variant,
            events,
            interface: interface_hash(C::INTERFACE),
            input_ranges: input_ranges(C::INTERFACE),
            config: None,
            live: initial::<C>(),
            outputs: vec![0.0; C::INTERFACE.output_len()],
            stored: BTreeMap::new(),
        })
    }

    /// The frame of every call: is it allowed now, does it panic, and what to tell the logger.
    pub fn run(
        &mut self,
        function: &str,
        call: Call,
        body: impl FnOnce(&mut Self) -> Result<(), Error>,
    ) -> Answer {
        let state = self.live.lifecycle;
        // The message is made inside the guard: a model's `Display` may panic too.
        let tell = |error: Error| (error.is_discard(), format!("{function}: {error}"));
        let result = if call.allowed_in(state) {
            guard::catch(|| body(self).map_err(tell)).unwrap_or_else(|panic| {
                self.live.lifecycle = Lifecycle::Failed;
                Err(tell(Error::Panic(panic)))
            })
        } else {
            Err(tell(Error::NotAllowed { state: state.name() }))
        };
        match result {
            Ok(()) => Answer::Done,
            Err((true, message)) => {
                self.logger.discard(&message);
                Answer::Discard
            }
            Err((false, message)) => {
                self.logger.error(&message);
                Answer::Error
            }
        }
    }

    /// Start and stop time, before Initialization Mode.
    pub fn set_experiment(&mut self, start_s: f64, stop_s: Option<f64>) -> Result<(), Error> {
        if start_s != 0.0 {
            return Err(Error::StartTime(start_s));
        }
        self.live.stop = match stop_s {
            Some(stop_s) => last_tick(stop_s).ok_or(Error::StopTime(stop_s))?,
            None => NO_STOP,
        };
        Ok(())
    }

    /// Creates the component, so that outputs can be read. Inputs have no influence on it.
    pub fn enter_initialization(&mut self) -> Result<(), Error> {
        self.create()?;
        self.live.lifecycle = Lifecycle::Initialization;
        Ok(())
    }

    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        let handled = self.events != Events::Unheard;
        self.live.lifecycle = if handled { Lifecycle::Event } else { Lifecycle::Stepping };
        Ok(())
    }

    pub fn enter_event_mode(&mut self) -> Result<(), Error> {
        if self.events == Events::Unheard {
            return Err(Error::EventModeUnused);
        }
        self.live.lifecycle = Lifecycle::Event;
        Ok(())
    }

    pub fn enter_step_mode(&mut self) -> Result<(), Error> {
        self.live.lifecycle = Lifecycle::Stepping;
        Ok(())
    }

    pub fn terminate(&mut self) -> Result<(), Error> {
        self.live.lifecycle = Lifecycle::Terminated;
        Ok(())
    }

    /// Back to the state after instantiation; stored states stay.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.logger.reset();
        self.config = None;
        self.live = initial::<C>();
        Ok(())
    }

    /// Advances from `from_s` by `duration_s`. Seconds end here: inside are whole ticks.
    pub fn step(&mut self, from_s: f64, duration_s: f64) -> Result<Stepped, Error> {
        let now = self.live.now;
        // The nearest tick counts: importers that add up step sizes drift away from it.
        if (from_s / TICK_S).round() != now.0 as f64 {
            return Err(Error::CommunicationPoint { given: from_s, now: now.seconds() });
        }
        if duration_s.is_nan() || duration_s <= 0.0 {
            return Err(Error::NoStep(duration_s));
        }
        let duration = Ticks::from_seconds(duration_s)
            .ok()
            .filter(|duration| *duration > Ticks::ZERO)
            .ok_or(Error::StepSize(NotWholeTicks { seconds: duration_s }))?;
        let next = now + duration;
        if next > self.live.stop {
            return Err(Error::PassesStop { from: now.seconds(), to: next.seconds() });
        }
        let (Some(config), Some(state)) = (&self.config, &mut self.live.state) else {
            unreachable!("from Initialization Mode on there is a component");
        };
        let inputs = &self.live.inputs;
        let stepped = match self.events {
            Events::ReturnEarly => config.component.step_to_event(state, inputs, duration),
            _ => config.component.step(state, inputs, duration).map(|report| (duration, report)),
        };
        let (passed, mut report) = stepped.map_err(|source| {
            self.live.lifecycle = Lifecycle::Failed;
            Error::Step(source)
        })?;
        let happened = report.event;
        report.terminate &= self.live.parameters.terminate_at_end;
        report.event &= self.events != Events::Unheard;
        self.live.now += passed;
        self.live.ended = report.terminate;
        self.refresh_outputs();
        let time_s = self.live.now.seconds();
        if happened {
            self.logger.event(&format!("t = {time_s} s: event"));
        }
        if report.terminate {
            self.logger.event(&format!("t = {time_s} s: the run has reached its end"));
        }
        Ok(Stepped { time_s, early: passed < duration, report })
    }

    /// Whether the last step asked for the end of the run.
    pub(crate) fn has_ended(&self) -> bool {
        self.live.ended
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.live.now.seconds()
    }

    /// (Re)creates the component from the current parameters. On error nothing has changed.
    pub(crate) fn create(&mut self) -> Result<(), Error> {
        let (config, state) = self.load(&self.live.parameters)?;
        self.config = Some(config);
        self.live.state = Some(state);
        self.refresh_outputs();
        Ok(())
    }

    /// The component under some parameters, and its state at t = 0.
    pub(crate) fn load(&self, given: &Parameters) -> Result<(Arc<Config<C>>, C::State), Error> {
        let settings = Settings { scenario_file: self.scenario_path(&given.scenario_file)? };
        let changes = text(&given.scenario_changes, CHANGES_NAME)?;
        let (component, state) = C::create_changed(&settings, changes).map_err(Error::Create)?;
        self.logger.event(&format!("loaded {}", settings.scenario_file.display()));
        let fingerprint = fingerprint(&component);
        Ok((Arc::new(Config { component, fingerprint }), state))
    }

    pub(crate) fn refresh_outputs(&mut self) {
        if let (Some(config), Some(state)) = (&self.config, &self.live.state) {
            config.component.outputs(state, &mut self.outputs);
        }
    }

    fn scenario_path(&self, parameter: &CStr) -> Result<PathBuf, Error> {
        let text = text(parameter, SCENARIO_NAME)?;
        let file = Path::new(if text.is_empty() { DEFAULT_SCENARIO } else { text });
        match &self.resources {
            _ if file.is_absolute() => Ok(file.to_owned()),
            Some(resources) => Ok(resources.join(file)),
            None => Err(Error::NoResources { parameter: text.to_owned() }),
        }
    }
}

fn text<'a>(value: &'a CStr, name: &str) -> Result<&'a str, Error> {
    value.to_str().map_err(|_| Error::NotUtf8 { what: name.to_owned() })
}

fn initial<C: Component>() -> Snapshot<C::State> {
    Snapshot {
        lifecycle: Lifecycle::Instantiated,
        parameters: Parameters::default(),
        now: Ticks::ZERO,
        stop: NO_STOP,
        ended: false,
        inputs: input_starts(C::INTERFACE),
        state: None,
    }
}

/// The last whole tick not after `seconds`, with the same nanosecond of slack as `Ticks`;
/// `None` if there is none after 0.
fn last_tick(seconds: f64) -> Option<Ticks> {
    let ticks = ((seconds + 1e-9) / TICK_S).floor();
    // A stop time beyond u64 ticks saturates: it is no limit.
    (ticks >= 1.0).then_some(Ticks(ticks as u64))
}
