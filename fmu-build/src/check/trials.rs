//! The trials of one FMU, each from a fresh load of its library.

use std::thread;

use fmi_adapter::variables::{CHANGES_REFERENCE, SCENARIO_REFERENCE, TIME_REFERENCE};

use super::Unpacked;
use super::drive::{Bits, Drive, STEP_S, done, time_s};
use crate::importer::{Answer, DISCARD, ERROR, Instance, Library, Refusal};

type Trial = fn(&Unpacked) -> Result<String, String>;

pub const TRIALS: [(&str, Trial); 13] = [
    ("load", load),
    ("wrong token", wrong_token),
    ("fly", fly),
    ("two instances", two_instances),
    ("threads", threads),
    ("save and restore", save_and_restore),
    ("serialise", serialise),
    ("damaged states", damaged_states),
    ("wrong calls", wrong_calls),
    ("wrong scenario", wrong_scenario),
    ("reset", reset),
    ("many instances", many_instances),
    ("unload", unload),
];

/// Steps of a flight, and after how many a state is saved.
const STEPS: u32 = 100;
const SAVED: u32 = 40;
const THREADS: usize = 4;
const INSTANCES: usize = 200;

/// A loaded library with what its instances are made from.
struct Bench<'a> {
    fmu: &'a Unpacked,
    library: Library,
    drive: Drive,
}

impl<'a> Bench<'a> {
    fn new(fmu: &'a Unpacked) -> Result<Self, String> {
        let library = Library::load(&fmu.library, fmu.is_fmi2()).map_err(|e| e.to_string())?;
        Ok(Self { fmu, library, drive: Drive::new(fmu.model, fmu.variant) })
    }

    fn create(&self) -> Result<Instance<'_>, String> {
        let created = self.library.instantiate(&self.fmu.token(), &self.fmu.resources());
        done("instantiation", created)
    }

    /// In Step Mode at 0.
    fn start(&self) -> Result<Instance<'_>, String> {
        let instance = self.create()?;
        done("initialisation", instance.initialize())?;
        Ok(instance)
    }

    /// The whole flight of a new instance.
    fn flight(&self) -> Result<Bits, String> {
        self.drive.fly(&self.start()?, 0..STEPS)
    }
}

fn load(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let (version, expected) = (bench.library.version(), if fmu.is_fmi2() { "2.0" } else { "3.0" });
    check(version == expected, || format!("the library says that it is FMI \"{version}\""))?;
    let status = bench.library.step_nothing();
    check(status == ERROR, || format!("a step of no instance gave status {status}"))?;
    Ok(format!("FMI {version}; a null instance is an error"))
}

fn wrong_token(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let answer = bench.library.instantiate("of another FMU", &fmu.resources());
    refused("a wrong token", answer.map(drop), ERROR)
}

fn fly(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let bits = bench.flight()?;
    let width = bits.len() / STEPS as usize;
    let (first, last) = (&bits[..width], &bits[bits.len() - width..]);
    let moved = first.iter().zip(last).filter(|(first, last)| first != last).count();
    check(moved > 0, || "no output ever changes".to_owned())?;
    let last_s = time_s(STEPS);
    Ok(format!("{STEPS} steps to {last_s} s; {moved} of {width} outputs change"))
}

fn two_instances(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let (one, other) = (bench.start()?, bench.start()?);
    let (mut first, mut second) = (Bits::new(), Bits::new());
    for number in 0..STEPS {
        first.extend(bench.drive.fly(&one, number..number + 1)?);
        second.extend(bench.drive.fly(&other, number..number + 1)?);
    }
    same(&first, &second)?;
    same(&first, &bench.flight()?)?;
    Ok("step by step in turns: equal bits, and equal to those of one alone".to_owned())
}

fn threads(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let alone = bench.flight()?;
    thread::scope(|scope| {
        let flights: Vec<_> = (0..THREADS).map(|_| scope.spawn(|| bench.flight())).collect();
        for flight in flights {
            same(&alone, &flight.join().map_err(|_| "a thread ended early".to_owned())??)?;
        }
        Ok(format!("{THREADS} instances in {THREADS} threads: equal bits"))
    })
}

fn save_and_restore(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let instance = bench.start()?;
    bench.drive.fly(&instance, 0..SAVED)?;
    let state = done("saving", instance.state())?;
    let flown = bench.drive.fly(&instance, SAVED..STEPS)?;
    done("restoring", instance.restore(state))?;
    same(&flown, &bench.drive.fly(&instance, SAVED..STEPS)?)?;
    done("freeing a state", instance.free_state(state))?;
    refused("a freed state", instance.restore(state), ERROR)?;
    Ok(format!("from {} s: equal bits again; a freed state is an error", time_s(SAVED)))
}

fn serialise(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let instance = bench.start()?;
    bench.drive.fly(&instance, 0..SAVED)?;
    let bytes = serialised(&instance)?;
    let flown = bench.drive.fly(&instance, SAVED..STEPS)?;
    let other = bench.create()?;
    done("restoring", other.restore(done("deserialising", other.deserialize(&bytes))?))?;
    check(serialised(&other)? == bytes, || "other bytes when serialised again".to_owned())?;
    same(&flown, &bench.drive.fly(&other, SAVED..STEPS)?)?;
    Ok(format!("{} bytes; another instance goes on with equal bits", bytes.len()))
}

fn damaged_states(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let instance = bench.start()?;
    let mut flown = bench.drive.fly(&instance, 0..SAVED)?;
    let bytes = serialised(&instance)?;
    let mut count = 0;
    // Some sixty places all over it, the first and the last byte among them.
    for at in (0..bytes.len()).step_by(bytes.len().div_ceil(60)).chain([bytes.len() - 1]) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x10;
        for damaged in [&flipped, &bytes[..at], &[&bytes[..], &bytes[..=at]].concat()] {
            let what = format!("a state damaged at byte {at}");
            refused(&what, instance.deserialize(damaged).map(drop), ERROR)?;
            count += 1;
        }
    }
    flown.extend(bench.drive.fly(&instance, SAVED..STEPS)?);
    same(&bench.flight()?, &flown)?;
    Ok(format!(
        "{count} corrupt, truncated and extended states: each an error that changes nothing"
    ))
}

fn wrong_calls(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let (input, output) = bench.drive.first();
    let early = bench.create()?;
    let mut count = 0;
    let mut expect = |what: &str, answer: Answer, status: i32| {
        count += 1;
        refused(what, answer, status).map(drop)
    };
    expect("a step before initialisation", early.step(0.0, STEP_S).map(drop), ERROR)?;
    expect("reading an output too early", early.get(&[output], 1).map(drop), ERROR)?;
    expect("ending before the start", early.terminate(), ERROR)?;

    let instance = bench.start()?;
    let mut flown = bench.drive.fly(&instance, 0..SAVED)?;
    let now_s = time_s(SAVED);
    let step = |from_s, size_s| instance.step(from_s, size_s).map(drop);
    expect("a second initialisation", instance.enter_initialization(), ERROR)?;
    expect("an unknown reference", instance.set(&[u32::MAX], &[0.0]), ERROR)?;
    expect("reading an unknown reference", instance.get(&[u32::MAX], 1).map(drop), ERROR)?;
    expect("setting an output", instance.set(&[output], &[0.0]), ERROR)?;
    expect("setting the time", instance.set(&[TIME_REFERENCE], &[0.0]), ERROR)?;
    expect("a number for a string", instance.set(&[SCENARIO_REFERENCE], &[0.0]), ERROR)?;
    expect("a parameter after the start", instance.set_string(SCENARIO_REFERENCE, "x"), ERROR)?;
    for value in [f64::NAN, f64::INFINITY] {
        expect(&format!("an input of {value}"), instance.set(&[input], &[value]), ERROR)?;
    }
    for size_s in [0.0, -STEP_S, f64::NAN] {
        expect(&format!("a step of {size_s} s"), step(now_s, size_s), ERROR)?;
    }
    expect("a step from elsewhere", step(now_s + 1.0, STEP_S), ERROR)?;
    // A tick and a half: another size may follow.
    expect("a step between two ticks", step(now_s, 0.0015), DISCARD)?;
    if !fmu.is_fmi2() {
        // FMI 2.0 does not say how many values there are.
        expect("too few values", instance.set(&[input, input], &[0.0]), ERROR)?;
    }
    flown.extend(bench.drive.fly(&instance, SAVED..STEPS)?);
    same(&bench.flight()?, &flown)?;
    done("the end", instance.terminate())?;
    expect("a step after the end", step(time_s(STEPS), STEP_S), ERROR)?;
    Ok(format!("{count}, each refused with a message; the run goes on as if they had not been"))
}

fn wrong_scenario(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let instance = bench.create()?;
    let file = "scenarios/of-nobody.toml";
    done("setting scenario_file", instance.set_string(SCENARIO_REFERENCE, file))?;
    let answer = instance.initialize();
    let named = answer.as_ref().is_err_and(|r| r.messages.iter().any(|m| m.contains(file)));
    refused("a missing scenario", answer, ERROR)?;
    check(named, || "the message does not name the missing scenario".to_owned())?;
    done("reset", instance.reset())?;
    let change = "run.stop_time = -1";
    done("setting scenario_changes", instance.set_string(CHANGES_REFERENCE, change))?;
    refused("a negative stop time", instance.initialize(), ERROR)?;
    done("reset", instance.reset())?;
    done("initialisation", instance.initialize())?;
    same(&bench.flight()?, &bench.drive.fly(&instance, 0..STEPS)?)?;
    Ok("a missing file and a wrong value are errors that name them; Reset recovers".to_owned())
}

fn reset(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    let instance = bench.start()?;
    let flown = bench.drive.fly(&instance, 0..STEPS)?;
    done("reset", instance.reset())?;
    done("initialisation", instance.initialize())?;
    same(&flown, &bench.drive.fly(&instance, 0..STEPS)?)?;
    Ok("equal bits again".to_owned())
}

fn many_instances(fmu: &Unpacked) -> Result<String, String> {
    let bench = Bench::new(fmu)?;
    for _ in 0..INSTANCES {
        bench.start()?;
    }
    let together = (0..INSTANCES).map(|_| bench.create()).collect::<Result<Vec<_>, _>>()?;
    drop(together);
    same(&bench.flight()?, &bench.flight()?)?;
    Ok(format!("{INSTANCES} one after another, {INSTANCES} at once, then equal bits twice"))
}

fn unload(fmu: &Unpacked) -> Result<String, String> {
    let flown = Bench::new(fmu)?.flight()?;
    // Unloaded by now.
    same(&flown, &Bench::new(fmu)?.flight()?)?;
    Ok("unloaded, loaded again: equal bits".to_owned())
}

fn serialised(instance: &Instance) -> Result<Vec<u8>, String> {
    let state = done("saving", instance.state())?;
    let bytes = done("serialising", instance.serialize(state))?;
    check(!bytes.is_empty(), || "a state of no bytes".to_owned())?;
    Ok(bytes)
}

/// `what` was refused with this status and a message, which is the note.
fn refused(what: &str, answer: Answer, expected: i32) -> Result<String, String> {
    match answer {
        Ok(()) => Err(format!("{what} was accepted")),
        Err(Refusal { status, .. }) if status != expected => {
            Err(format!("{what} gave status {status}, expected {expected}"))
        }
        Err(Refusal { messages, .. }) if messages.is_empty() => {
            Err(format!("{what} was refused without a message"))
        }
        Err(Refusal { messages, .. }) => Ok(messages.join("; ")),
    }
}

fn same(expected: &Bits, found: &Bits) -> Result<(), String> {
    let differ = expected.iter().zip(found).filter(|(expected, found)| expected != found).count();
    let is_same = differ == 0 && expected.len() == found.len();
    check(is_same, || format!("{differ} of {} values have other bits", expected.len()))
}

fn check(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise()) }
}
