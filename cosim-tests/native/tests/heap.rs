//! What guidance takes from the heap in flight: nothing from plan to plan; a plan returns all that
//! it takes but itself, and replaces the last one.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use guidance_fmu::Guidance;
use lander_models::signals::{GUIDANCE, TRUTH, connections};
use lander_models::{Component, Settings, Ticks};
use truth_model::TruthModel;

/// The system's allocator, counting what this thread takes and returns.
struct Counting;

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
    static BYTES: Cell<i64> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator as it came; the counters allocate nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.with(|calls| calls.set(calls.get() + 1));
        BYTES.with(|bytes| bytes.set(bytes.get() + layout.size() as i64));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        BYTES.with(|bytes| bytes.set(bytes.get() - layout.size() as i64));
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static HEAP: Counting = Counting;

#[test]
fn guidance_does_not_grow_in_flight() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/scenarios/");
    let settings = Settings { scenario_file: format!("{folder}monte-carlo.toml").into() };
    let (truth, mut truth_state) = TruthModel::create(&settings).unwrap();
    let (guidance, mut state) = Guidance::create(&settings).unwrap();
    let mut truth_outputs = vec![0.0; TRUTH.output_len()];
    let mut inputs = vec![0.0; GUIDANCE.input_len()];
    let mut outputs = vec![0.0; GUIDANCE.output_len()];
    let mut commands = vec![0.0; TRUTH.input_len()];
    let plans_at = GUIDANCE.output_offset("plans_accepted").unwrap();
    let failed_at = GUIDANCE.output_offset("plans_failed").unwrap();
    // Held after each step that planned, bytes.
    let mut held = Vec::new();
    let start = BYTES.get();
    loop {
        truth.outputs(&truth_state, &mut truth_outputs);
        for (from, to, size) in connections(&TRUTH, &GUIDANCE) {
            inputs[to..to + size].copy_from_slice(&truth_outputs[from..from + size]);
        }
        let plans = outputs[plans_at] + outputs[failed_at];
        let (calls, bytes) = (CALLS.get(), BYTES.get());
        guidance.step(&mut state, &inputs, Ticks(10)).unwrap();
        guidance.outputs(&state, &mut outputs);
        let (calls, grown) = (CALLS.get() - calls, BYTES.get() - bytes);
        if outputs[plans_at] + outputs[failed_at] > plans {
            held.push(held.last().unwrap_or(&0) + grown);
        } else {
            assert_eq!((calls, grown), (0, 0), "between plans, at {} s", state.now.seconds());
        }
        for (from, to, size) in connections(&GUIDANCE, &TRUTH) {
            commands[to..to + size].copy_from_slice(&outputs[from..from + size]);
        }
        if truth.step(&mut truth_state, &commands, Ticks(10)).unwrap().terminate {
            break;
        }
    }
    assert!(held.len() > 20, "only {} plans", held.len());
    // The first plan has the most intervals: no later one holds more.
    assert!(held.iter().all(|bytes| *bytes <= held[0]), "{held:?} bytes");
    assert!(held[0] > 0 && BYTES.get() > start, "the allocator counts");
}
