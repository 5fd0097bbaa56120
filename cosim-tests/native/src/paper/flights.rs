//! The report's landings: the campaign `paper-monte-carlo` under several guidance schemes, resumable.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use lander_models::vehicle::{Engine, Vehicle};

use crate::landing::Error;
use crate::study::campaign::{Campaign, End};
use crate::study::data::{self, Data, Words};
use crate::study::row::Columns;
use crate::study::{Study, StudyError, table};

/// The study that every scheme flies: its disturbances and failure modes.
const BASE: &str = "campaigns/paper-monte-carlo.toml";
/// The vehicle that `as_fired` takes the engine's range from.
const DEMONSTRATED: &str = "vehicles/bug-demonstrated.toml";
/// Longer than any flight.
const NEVER_S: f64 = 60.0;

/// How guidance flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// Between two plans.
    pub replan_s: f64,
    /// Whether plans are followed with feedback, engine errors compensated, failures answered and the terminal law
    /// lands; else each plan's thrust is flown as it stands.
    pub feedback: bool,
    /// Whether the engine's range is the one that was fired, not the one designed.
    pub as_fired: bool,
}

/// One plan, its thrust flown to the end.
pub const OPEN_LOOP: Scheme = Scheme::of(NEVER_S, false);
/// The paper's: a plan each ten seconds, its thrust flown in between.
pub const PAPER: Scheme = Scheme::of(10.0, false);
/// This kit's.
pub const CLOSED_LOOP: Scheme = Scheme::of(0.5, true);
/// This kit's, with BUG as it was demonstrated.
pub const AS_FIRED: Scheme = Scheme { as_fired: true, ..CLOSED_LOOP };
/// Replanning periods of the sweep, s.
pub const CADENCE_S: [f64; 5] = [10.0, 5.0, 2.0, 1.0, 0.5];

impl Scheme {
    pub const fn of(replan_s: f64, feedback: bool) -> Self {
        Self { replan_s, feedback, as_fired: false }
    }

    pub fn name(&self) -> String {
        let laws = if self.feedback { "feedback" } else { "plan-only" };
        let engine = if self.as_fired { "-as-fired" } else { "" };
        match self.replan_s {
            NEVER_S => format!("open-loop-{laws}{engine}"),
            period_s => format!("{laws}-{}ms{engine}", (1e3 * period_s).round()),
        }
    }

    /// The scheme's study.
    ///
    /// # Errors
    /// A study or a file of it that is missing or wrong.
    pub fn study(&self, models: &Path, runs: u64) -> Result<Study, StudyError> {
        let file = models.join(BASE);
        let text = std::fs::read_to_string(&file)
            .map_err(|source| StudyError::File { file: file.clone(), source })?;
        let mut text = text
            .replacen("name = \"paper-monte-carlo\"", &format!("name = \"{}\"", self.name()), 1)
            .replacen("runs = { value = 1000,", &format!("runs = {{ value = {runs},"), 1);
        let design = |key: &str, value: &str| {
            format!("\n[[design]]\nkey = \"{key}\"\ndistribution = \"constant\"\nvalue = {value}\n")
        };
        let number = |value: f64, unit: &str| format!("{{ value = {value:?}, unit = \"{unit}\" }}");
        text += &design("scenario.guidance.replan_period", &number(self.replan_s, "s"));
        let word = if self.feedback { "\"on\"" } else { "\"off\"" };
        for law in ["compensation", "tracking", "terminal_law", "fault_response"] {
            text += &design(&format!("scenario.guidance.{law}"), word);
        }
        if self.as_fired {
            let Engine { thrust_min_n, thrust_max_n, dead_zone_n, .. } =
                Vehicle::load(&models.join(DEMONSTRATED))?.engine;
            for (key, thrust_n) in [
                ("thrust_max", thrust_max_n),
                ("thrust_min", thrust_min_n),
                ("dead_zone", dead_zone_n),
            ] {
                text += &design(&format!("vehicle.engine.{key}"), &number(thrust_n, "N"));
            }
        }
        Study::parse(&file, &text)
    }
}

/// The results that landings are judged by.
const JUDGED: [&str; 5] = [
    "contact_speed_down_m_s",
    "contact_speed_across_m_s",
    "contact_tilt_deg",
    "contact_rate_deg_s",
    "position_error_m",
];

/// The landings of one scheme.
pub struct Flown {
    pub scheme: Scheme,
    pub study: Study,
    pub columns: Columns,
    pub outcomes: Words,
    pub failures: Words,
    sorted: BTreeMap<&'static str, Vec<f64>>,
}

/// All landings of the report: of N runs the open loop, the paper's and this kit's with either engine, and a fifth as many, 20 at least,
/// of every other cadence.
pub struct Flights(Vec<Flown>);

impl Flights {
    /// Flies what is not there yet below `folder`. `None` if interrupted.
    ///
    /// # Errors
    /// A study that is wrong, a folder that can't be written.
    pub fn fly(
        models: &Path,
        folder: &Path,
        runs: u64,
        threads: usize,
        interrupted: &AtomicBool,
    ) -> Result<Option<Self>, Error> {
        let fewer = (runs / 5).max(20).min(runs);
        let main = [OPEN_LOOP, PAPER, CLOSED_LOOP, AS_FIRED];
        let sweep = [false, true]
            .into_iter()
            .flat_map(|feedback| CADENCE_S.map(|replan_s| Scheme::of(replan_s, feedback)));
        let mut schemes: Vec<(Scheme, u64)> = main.map(|scheme| (scheme, runs)).to_vec();
        schemes.extend(sweep.filter(|scheme| !main.contains(scheme)).map(|scheme| (scheme, fewer)));
        let count = schemes.len();
        let mut flown = Vec::new();
        for (number, (scheme, runs)) in (1..).zip(schemes) {
            // Nobody has to listen.
            let _ = writeln!(std::io::stderr(), "landings {number} of {count}: {}", scheme.name());
            let study = scheme.study(models, runs)?;
            let columns = Columns::new(&study)?;
            let campaign = Campaign::new(&study, &columns, folder);
            if campaign.run(None, threads, interrupted)? == End::Interrupted {
                return Ok(None);
            }
            table::merge(&campaign)?;
            let reader = data::open(&campaign)?;
            flown.push(Flown::read(scheme, study.clone(), columns.clone(), Data::new(&reader)?)?);
        }
        Ok(Some(Self(flown)))
    }

    /// The landings of a scheme; every one of `fly` is there.
    pub fn of(&self, scheme: Scheme) -> Option<&Flown> {
        self.0.iter().find(|flown| flown.scheme == scheme)
    }
}

impl Flown {
    fn read(
        scheme: Scheme,
        study: Study,
        columns: Columns,
        data: Data,
    ) -> Result<Self, StudyError> {
        let sorted = |name| Ok::<_, StudyError>((name, data.sorted(name)?));
        let sorted = JUDGED.into_iter().map(sorted).collect::<Result<_, _>>()?;
        let Data { outcomes, failures, .. } = data;
        Ok(Self { scheme, study, columns, outcomes, failures, sorted })
    }

    /// What was measured of a result of `JUDGED`, rising.
    pub fn sorted(&self, result: &str) -> &[f64] {
        self.sorted.get(result).map(Vec::as_slice).unwrap_or_default()
    }

    /// Runs with an outcome.
    pub fn count(&self, outcome: &str) -> usize {
        self.outcomes.iter().filter(|found| *found == outcome).count()
    }

    pub fn runs(&self) -> usize {
        self.outcomes.codes.len()
    }
}
