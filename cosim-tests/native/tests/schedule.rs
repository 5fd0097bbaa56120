//! `schedule.toml` says what the signal table says, and a wrong one is refused.

use cosim::schedule::{Action, Pair, Schedule, Side};
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{Outcome, Ticks};

const TEXT: &str = include_str!("../../schedule.toml");
const INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

fn description(name: &str) -> &'static str {
    let outputs = TRUTH.outputs.iter().chain(GUIDANCE.outputs);
    outputs.into_iter().find(|signal| signal.name == name).expect(name).description
}

/// `0 in_flight, 1 landed, …`, as the signal table documents codes.
fn documented(names: &[String]) -> String {
    let coded: Vec<String> =
        names.iter().enumerate().map(|(code, name)| format!("{code} {name}")).collect();
    coded.join(", ")
}

#[test]
fn truth_flies_a_step_with_the_command_computed_at_its_start() {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    assert_eq!(schedule.communication_step, Ticks(10));
    let step = |side| {
        let wanted = Action::Step { component: side };
        schedule.actions.iter().position(|action| *action == wanted).unwrap()
    };
    assert!(step(Side::Guidance) < step(Side::Truth));
}

#[test]
fn outcome_names_are_those_of_the_enum() {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    for outcome in Outcome::ALL {
        assert_eq!(schedule.code_name("outcome", outcome.code()), Some(outcome.name()));
    }
    assert_eq!(schedule.codes["outcome"].len(), Outcome::ALL.len());
}

#[test]
fn codes_are_those_the_signal_table_documents() {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    for (signal, names) in &schedule.codes {
        assert_eq!(documented(names), description(signal), "{signal}");
    }
}

#[test]
fn every_result_of_truth_is_in_the_results() {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    let unlisted: Vec<&str> = TRUTH
        .outputs
        .iter()
        .filter(|signal| signal.start.is_nan())
        .map(|signal| signal.name)
        .filter(|name| !schedule.results.iter().any(|listed| listed == name))
        .collect();
    assert_eq!(unlisted, Vec::<&str>::new());
}

#[test]
fn a_wrong_schedule_is_refused() {
    let cases = [
        ("value = 0.01, unit = \"s\"", "value = 10.0, unit = \"ms\"", "is in \"ms\""),
        ("value = 0.01", "value = 0.0105", "is not a whole"),
        ("value = 0.01", "value = 0.0", "must be greater than 0"),
        ("\"flight_time_s\"", "\"flight_time\"", "`flight_time` is no recorded output"),
        ("outcome = [", "verdict = [", "`verdict` is no recorded output"),
        ("lander-truth", "lunar-truth", "is not lander-truth"),
        ("do = \"step\", component = \"truth\"", "do = \"leap\"", "unknown variant `leap`"),
        ("component = \"guidance\" }", "component = \"gps\" }", "unknown variant `gps`"),
        ("from = \"truth\", to", "of = \"truth\", to", "unknown field `of`"),
        ("rows = ", "columns = ", "unknown field `columns`"),
    ];
    for (from, to, reason) in cases {
        let text = TEXT.replacen(from, to, 1);
        assert_ne!(text, TEXT, "the schedule no longer contains {from}");
        let error = Schedule::parse(&text, &INTERFACES).unwrap_err().to_string();
        assert!(error.contains(reason), "{to}: {error}");
    }
}
