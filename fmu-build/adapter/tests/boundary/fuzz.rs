//! Random calls with random arguments through the C symbols, within the one contract that C leaves
//! to the importer: handles are alive, arrays as long as said, strings end.
//!
//! Whatever is called, the host lives; each error comes with exactly one message; and a reset
//! instance is as good as new. `FUZZ_SEQUENCES` sets how many sequences are run, and
//! fmu-build/README.md has the command for valgrind.

use std::ffi::{CStr, c_void};
use std::ptr;

use fmi_adapter::fmi3::{Events, Status};
use lander_models::random::uniforms;

use crate::harness::{Importer, Resources};
use crate::integrator::{
    DIVERGE, END, EVENT, PANIC, PANIC_ON_CREATE, RATE_1, RATE_2, STEPS, TROUBLE, X_1, X_2,
};

const CALLS: usize = 60;

/// The source of all choices.
struct Dice<I>(I);

impl<I: Iterator<Item = f64>> Dice<I> {
    fn below(&mut self, count: usize) -> usize {
        (self.0.next().unwrap() * count as f64) as usize
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    fn flag(&mut self) -> bool {
        self.below(2) == 1
    }

    fn number(&mut self) -> f64 {
        let odd = [f64::NAN, f64::INFINITY, -1.0, 1e-10, 1e300, PANIC, DIVERGE, EVENT, END];
        let plain = [0.0, 0.001, 0.01, 0.013, 0.25, 1.0];
        if self.below(4) == 0 { self.one(&odd) } else { self.one(&plain) }
    }

    fn references(&mut self) -> Vec<u32> {
        let all = [0, 1, 2, 3, 4, 999, RATE_1, RATE_2, TROUBLE, X_1, X_2, STEPS, 2003, u32::MAX];
        let count = self.below(4);
        (0..count).map(|_| self.one(&all)).collect()
    }

    /// Null now and then.
    fn pointer<T>(&mut self, to: *mut T) -> *mut T {
        if self.below(8) == 0 { ptr::null_mut() } else { to }
    }
}

/// What an importer has collected in a sequence, and may misuse.
#[derive(Default)]
struct Loot {
    states: Vec<*mut c_void>,
    blobs: Vec<Vec<u8>>,
}

/// One call of either version. Returns its status.
fn call(
    dice: &mut Dice<impl Iterator<Item = f64>>,
    importer: &Importer,
    loot: &mut Loot,
) -> Status {
    let fmu = importer.instance;
    let time_s = importer_time(importer);
    let kind = dice.below(24);
    match kind {
        0..=3 => values(dice, fmu),
        4..=8 => step(dice, fmu, time_s),
        9..=14 => states(dice, fmu, loot),
        15 => strings(dice, fmu),
        _ => modes(dice, fmu, kind),
    }
}

/// The clock if it can be read: a fuzzer that never guesses the time would never step.
fn importer_time(importer: &Importer) -> f64 {
    let mut time = [0.0];
    importer.try_get(&[0], &mut time);
    importer.take();
    time[0]
}

fn values(dice: &mut Dice<impl Iterator<Item = f64>>, fmu: *mut c_void) -> Status {
    let references = dice.references();
    let (r, n) = (references.as_ptr(), references.len());
    let said = if dice.below(6) == 0 { n + 1 } else { n };
    // Room for what is said, whatever is said.
    let mut numbers = vec![0.0; n + 1];
    numbers.fill_with(|| dice.number());
    let mut flags = vec![2_u8; n + 1];
    let mut booleans = vec![5_i32; n + 1];
    let (v, r) = (dice.pointer(numbers.as_mut_ptr()), dice.pointer(r.cast_mut()).cast_const());
    unsafe {
        match dice.below(9) {
            0 => crate::fmi3GetFloat64(fmu, r, n, v, said),
            1 => crate::fmi3SetFloat64(fmu, r, n, v, said),
            2 => crate::fmi2GetReal(fmu, r, n, v),
            3 => crate::fmi2SetReal(fmu, r, n, v),
            4 => crate::fmi3GetBoolean(fmu, r, n, flags.as_mut_ptr(), said),
            5 => crate::fmi3SetBoolean(fmu, r, n, flags.as_ptr(), said),
            6 => crate::fmi2GetBoolean(fmu, r, n, booleans.as_mut_ptr()),
            7 => crate::fmi2SetBoolean(fmu, r, n, booleans.as_ptr()),
            _ => crate::fmi3GetInt32(fmu, r, n, booleans.as_mut_ptr(), said),
        }
    }
}

fn step(dice: &mut Dice<impl Iterator<Item = f64>>, fmu: *mut c_void, time_s: f64) -> Status {
    let from_s = if dice.below(8) == 0 { dice.number() } else { time_s };
    let size_s = dice.number();
    let (mut event, mut end, mut early, mut reached_s) = (false, false, false, 0.0);
    unsafe {
        if dice.flag() {
            return crate::fmi2DoStep(fmu, from_s, size_s, 1);
        }
        let (event, end) = (dice.pointer(&raw mut event), dice.pointer(&raw mut end));
        crate::fmi3DoStep(fmu, from_s, size_s, true, event, end, &mut early, &mut reached_s)
    }
}

fn states(dice: &mut Dice<impl Iterator<Item = f64>>, fmu: *mut c_void, loot: &mut Loot) -> Status {
    let wild = [ptr::null_mut(), ptr::without_provenance_mut(8), fmu];
    let known = if loot.states.is_empty() { ptr::null_mut() } else { dice.one(&loot.states) };
    let mut state = if dice.below(5) == 0 { dice.one(&wild) } else { known };
    let mut size = 0;
    unsafe {
        match dice.below(6) {
            0 => {
                if dice.flag() {
                    state = ptr::null_mut();
                }
                let status = crate::fmi3GetFMUState(fmu, &mut state);
                loot.states.push(state);
                status
            }
            1 => crate::fmi3SetFMUState(fmu, state),
            // The freed handle stays in the loot: it will be used again.
            2 => crate::fmi2FreeFMUstate(fmu, &mut state),
            3 => crate::fmi3SerializedFMUStateSize(fmu, state, dice.pointer(&raw mut size)),
            4 => {
                if crate::fmi2SerializedFMUstateSize(fmu, state, &mut size) != Status::Ok {
                    return Status::Error;
                }
                let mut blob = vec![0; size];
                let said = if dice.below(4) == 0 { size - 1 } else { size };
                let status = crate::fmi3SerializeFMUState(fmu, state, blob.as_mut_ptr(), said);
                loot.blobs.push(blob);
                status
            }
            _ => {
                let mut blob = loot.blobs.last().cloned().unwrap_or_default();
                let length = blob.len();
                if dice.flag() && length > 0 {
                    blob[dice.below(length)] ^= 1 << dice.below(8);
                    blob.truncate(dice.below(length + 1));
                }
                let (bytes, mut state) = (blob.as_ptr(), ptr::null_mut());
                crate::fmi3DeserializeFMUState(fmu, bytes, blob.len(), &mut state)
            }
        }
    }
}

fn strings(dice: &mut Dice<impl Iterator<Item = f64>>, fmu: *mut c_void) -> Status {
    let texts: [&CStr; 6] =
        [c"", c"scenarios/other.toml", c"scenarios/panic.toml", c"nowhere.toml", c"\xff", c"%n#1#"];
    let mut text = dice.one(&texts).as_ptr();
    let reference = dice.one(&[1, 1, 1, 3, 0, X_1]);
    unsafe {
        match dice.below(4) {
            0 => crate::fmi3GetString(fmu, &reference, 1, &mut text, 1),
            1 => crate::fmi2SetString(fmu, &reference, 1, &ptr::null()),
            _ => crate::fmi3SetString(fmu, &reference, 1, &text, 1),
        }
    }
}

fn modes(dice: &mut Dice<impl Iterator<Item = f64>>, fmu: *mut c_void, kind: usize) -> Status {
    let number = dice.number();
    let (mut flag, mut time_s) = (false, 0.0);
    let flag = dice.pointer(&raw mut flag);
    unsafe {
        match kind {
            16 => crate::fmi3EnterInitializationMode(fmu, false, 0.0, 0.0, dice.flag(), number),
            17 => crate::fmi2EnterInitializationMode(fmu),
            18 => crate::fmi3ExitInitializationMode(fmu),
            19 => crate::fmi3EnterEventMode(fmu),
            20 => crate::fmi3EnterStepMode(fmu),
            21 => {
                let s = &mut time_s;
                crate::fmi3UpdateDiscreteStates(fmu, flag, flag, flag, flag, flag, s)
            }
            22 => match dice.below(6) {
                0 => crate::fmi3Terminate(fmu),
                1 => crate::fmi2SetupExperiment(fmu, 0, 0.0, number, 0, 0.0),
                2 => crate::fmi2GetRealStatus(fmu, dice.below(5) as i32, &mut time_s),
                3 => crate::fmi3SetDebugLogging(fmu, dice.flag(), 1, &c"logEvents".as_ptr()),
                4 => crate::fmi3GetOutputDerivatives(fmu, ptr::null(), 0, ptr::null(), &mut 0.0, 1),
                _ => crate::fmi2SetTime(fmu, number),
            },
            _ => crate::fmi2Reset(fmu),
        }
    }
}

/// Exactly one message for each error, none of its own for what was done.
fn check(importer: &Importer, status: Status, what: &str) {
    let messages = importer.take();
    let told = messages.iter().filter(|(level, ..)| *level == Status::Error).count();
    assert_eq!(told, usize::from(status == Status::Error), "{what}: {messages:?}");
}

/// From whatever state back to a first step with a known result.
fn recovers(importer: &Importer, what: &str) {
    importer.take();
    assert_eq!(unsafe { crate::fmi3Reset(importer.instance) }, Status::Ok, "{what}");
    assert_eq!(importer.enter(), Status::Ok, "{what}: {:?}", importer.take());
    unsafe { crate::fmi3ExitInitializationMode(importer.instance) };
    // Only an instance that hears of events is in Event Mode now.
    unsafe { crate::fmi3EnterStepMode(importer.instance) };
    assert_eq!(importer.step(0.0, 0.25).0, Status::Ok, "{what}");
    // x starts at the gain of 2 and grows at twice the rate's start of 0.5.
    assert_eq!(importer.get([X_1]), [2.25], "{what}");
    importer.take();
}

#[test]
fn no_sequence_of_calls_harms_the_host() {
    let sequences = std::env::var("FUZZ_SEQUENCES").map_or(2000, |n| n.parse().unwrap());
    let resources = Resources::new();
    resources.write("panic", PANIC_ON_CREATE);
    let mut done = 0;
    for seed in 0..sequences {
        let mut dice = Dice(uniforms(seed, "fuzz"));
        let heard = [Events::Unheard, Events::AtStepEnd, Events::ReturnEarly];
        let importers = [0, 1].map(|_| Importer::hearing(&resources, dice.one(&heard)));
        // Most sequences begin with a started instance: the others seldom get far.
        for importer in &importers {
            if dice.below(4) > 0 {
                importer.start();
            }
        }
        let mut loot = Loot::default();
        for number in 0..CALLS {
            // Both share the loot: a state of one is foreign to the other.
            let importer = &importers[dice.below(2)];
            let status = call(&mut dice, importer, &mut loot);
            done += u64::from(status == Status::Ok);
            check(importer, status, &format!("seed {seed}, call {number}"));
        }
        importers.iter().for_each(|importer| recovers(importer, &format!("seed {seed}")));
    }
    // A fuzzer that is refused at every turn gets nowhere; so does one that never errs.
    let share = done as f64 / (sequences * CALLS as u64) as f64;
    assert!((0.2..0.8).contains(&share), "{share} of all calls were done");
}
