//! One instance of a component, free of any FMI version: values, steps, states, and every check.

use std::collections::BTreeMap;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lander_models::time::TICK_S;
use lander_models::{Component, Settings, StepReport, Ticks};

use crate::error::Error;
use crate::lifecycle::{Call, Lifecycle};
use crate::logger::Logger;
use crate::snapshot::{Origin, Snapshot, fingerprint};
use crate::variables::{DEFAULT_SCENARIO, SCENARIO_NAME, input_starts, token};
use crate::{guard, variables};

/// The constant part, shared by an instance and the states taken from it.
pub(crate) struct Config<C> {
    component: C,
    pub(crate) fingerprint: [u8; 32],
}

pub struct Instance<C: Component> {
    pub(crate) logger: Logger,
    resources: Option<PathBuf>,
    token: [u8; 32],
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

/// What a successful step tells the importer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    pub time_s: f64,
    pub report: StepReport,
}

impl<C: Component> Instance<C> {
    /// An instance in state Instantiated. `given_token` comes from modelDescription.xml.
    pub fn new(
        given_token: &str,
        resources: Option<PathBuf>,
        logger: Logger,
    ) -> Result<Self, Error> {
        let token = token(C::INTERFACE);
        let expected = variables::hex(&token);
        if given_token != expected {
            return Err(Error::Token { given: given_token.to_owned(), expected });
        }
        Ok(Self {
            logger,
            resources,
            token,
            config: None,
            live: initial::<C>(),
            outputs: vec![0.0; C::INTERFACE.output_len()],
            stored: BTreeMap::new(),
        })
    }

    /// The frame of every call: is it allowed now, does it panic, and what to tell the logger.
    ///
    /// `true` is success.
    pub fn run(
        &mut self,
        function: &str,
        call: Call,
        body: impl FnOnce(&mut Self) -> Result<(), Error>,
    ) -> bool {
        let state = self.live.lifecycle;
        let result = if call.allowed_in(state) {
            // The message is made inside the guard: a model's `Display` may panic too.
            guard::catch(|| body(self).map_err(|error| error.to_string())).unwrap_or_else(|panic| {
                self.live.lifecycle = Lifecycle::Failed;
                Err(Error::Panic(panic).to_string())
            })
        } else {
            Err(Error::NotAllowed { state: state.name() }.to_string())
        };
        result.inspect_err(|message| self.logger.error(&format!("{function}: {message}"))).is_ok()
    }

    /// Creates the component, so that outputs can be read. Inputs have no influence on it.
    pub fn enter_initialization(&mut self, start_s: f64, stop_s: Option<f64>) -> Result<(), Error> {
        if start_s != 0.0 {
            return Err(Error::StartTime(start_s));
        }
        let stop = match stop_s {
            Some(stop_s) => last_tick(stop_s).ok_or(Error::StopTime(stop_s))?,
            None => Ticks(u64::MAX),
        };
        self.create()?;
        self.live.stop = stop;
        self.live.lifecycle = Lifecycle::Initialization;
        Ok(())
    }

    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        self.live.lifecycle = Lifecycle::Stepping;
        Ok(())
    }

    pub fn terminate(&mut self) -> Result<(), Error> {
        self.live.lifecycle = Lifecycle::Terminated;
        Ok(())
    }

    /// Back to the state after instantiation; stored states stay.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.config = None;
        self.live = initial::<C>();
        Ok(())
    }

    /// Advances from `from_s` by `duration_s`. Seconds end here: inside are whole ticks.
    pub fn step(&mut self, from_s: f64, duration_s: f64) -> Result<Stepped, Error> {
        let now = self.live.now;
        let duration = Ticks::from_seconds(duration_s).map_err(Error::StepSize)?;
        if duration == Ticks::ZERO {
            return Err(Error::EmptyStep);
        }
        if Ticks::from_seconds(from_s) != Ok(now) {
            return Err(Error::CommunicationPoint { given: from_s, now: now.seconds() });
        }
        let next = now + duration;
        if next > self.live.stop {
            return Err(Error::PassesStop { from: now.seconds(), to: next.seconds() });
        }
        let (Some(config), Some(state)) = (&self.config, &mut self.live.state) else {
            unreachable!("from Initialization Mode on there is a component");
        };
        let report =
            config.component.step(state, &self.live.inputs, duration).map_err(|source| {
                self.live.lifecycle = Lifecycle::Failed;
                Error::Step(source)
            })?;
        self.live.now = next;
        self.refresh_outputs();
        let time_s = next.seconds();
        if report.event {
            self.logger.event(&format!("t = {time_s} s: event"));
        }
        if report.terminate {
            self.logger.event(&format!("t = {time_s} s: the run has reached its end"));
        }
        Ok(Stepped { time_s, report })
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.live.now.seconds()
    }

    /// (Re)creates the component from the current parameters. On error nothing has changed.
    pub(crate) fn create(&mut self) -> Result<(), Error> {
        let (config, state) = self.load()?;
        self.config = Some(Arc::new(config));
        self.live.state = Some(state);
        self.refresh_outputs();
        self.logger.event(&format!("loaded {}", self.scenario_path()?.display()));
        Ok(())
    }

    pub(crate) fn load(&self) -> Result<(Config<C>, C::State), Error> {
        let scenario_file = self.scenario_path()?;
        let fingerprint = self.fingerprint_now();
        let path = scenario_file.display().to_string();
        let (component, state) = C::create(&Settings { scenario_file })
            .map_err(|source| Error::Create { path, source })?;
        Ok((Config { component, fingerprint }, state))
    }

    pub(crate) fn refresh_outputs(&mut self) {
        if let (Some(config), Some(state)) = (&self.config, &self.live.state) {
            config.component.outputs(state, &mut self.outputs);
        }
    }

    /// What a serialised state of this instance must match. A loaded component keeps the
    /// fingerprint of the file it was loaded from.
    pub(crate) fn origin(&self, config: Option<&Arc<Config<C>>>) -> Origin {
        let fingerprint = config.map_or_else(|| self.fingerprint_now(), |c| c.fingerprint);
        Origin { token: self.token, fingerprint }
    }

    fn fingerprint_now(&self) -> [u8; 32] {
        let content = self.scenario_path().ok().and_then(|path| std::fs::read(path).ok());
        fingerprint(self.live.scenario_file.as_bytes(), &content.unwrap_or_default())
    }

    fn scenario_path(&self) -> Result<PathBuf, Error> {
        let parameter = self.scenario_text()?;
        let file = Path::new(if parameter.is_empty() { DEFAULT_SCENARIO } else { parameter });
        match &self.resources {
            _ if file.is_absolute() => Ok(file.to_owned()),
            Some(resources) => Ok(resources.join(file)),
            None => Err(Error::NoResources { parameter: parameter.to_owned() }),
        }
    }

    fn scenario_text(&self) -> Result<&str, Error> {
        let text = self.live.scenario_file.to_str();
        text.map_err(|_| Error::NotUtf8 { what: SCENARIO_NAME.to_owned() })
    }
}

fn initial<C: Component>() -> Snapshot<C::State> {
    Snapshot {
        lifecycle: Lifecycle::Instantiated,
        scenario_file: CString::default(),
        now: Ticks::ZERO,
        stop: Ticks(u64::MAX),
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
