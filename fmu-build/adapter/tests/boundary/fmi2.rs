//! FMI 2.0: the same instance behind other symbols.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;

use fmi_adapter::Variant;
use fmi_adapter::fmi2::{Callbacks, LogMessage};
use fmi_adapter::fmi3::Status;
use lander_models::Component;

use crate::harness::{Importer, Messages, Resources};
use crate::integrator::{ALL_OUTPUTS, END, Integrator, PANIC, RATE_1, RATE_2, TROUBLE, X_1};

const TERMINATED: i32 = 3;
const LAST_SUCCESSFUL_TIME: i32 = 2;

/// As an importer's logger, but for the variable arguments, which Rust can't take: the message has
/// to be complete without them.
unsafe extern "C" fn collect(
    environment: *mut c_void,
    name: *const c_char,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    let text = |text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    assert_eq!(text(name), "test");
    let messages = unsafe { &mut *environment.cast::<Messages>() };
    messages.push((status, text(category), text(message)));
}

struct Fmi2 {
    instance: *mut c_void,
    messages: *mut Messages,
}

impl Fmi2 {
    fn with(token: *const c_char, location: *const c_char, kind: i32) -> Self {
        let messages = Box::into_raw(Box::new(Messages::new()));
        let plain: unsafe extern "C" fn(_, _, _, _, _) = collect;
        let callbacks = Callbacks {
            // SAFETY: on this platform a function that takes no variable arguments can be called
            // as one that does; the fixed ones are passed alike.
            logger: unsafe { std::mem::transmute::<*const (), LogMessage>(plain as *const ()) },
            allocate_memory: ptr::null_mut(),
            free_memory: ptr::null_mut(),
            step_finished: ptr::null_mut(),
            environment: messages.cast(),
        };
        let name = c"test".as_ptr();
        let instance =
            unsafe { crate::fmi2Instantiate(name, kind, token, location, &callbacks, 0, 0) };
        Self { instance, messages }
    }

    fn new(resources: &Resources) -> Self {
        let location = CString::new(format!("file://{}", resources.0.display())).unwrap();
        let importer = Self::with(token().as_ptr(), location.as_ptr(), 1);
        assert!(!importer.instance.is_null(), "{:?}", importer.take());
        importer
    }

    fn stepping(resources: &Resources) -> Self {
        let importer = Self::new(resources);
        unsafe {
            let fmu = importer.instance;
            assert_eq!(crate::fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
            assert_eq!(crate::fmi2EnterInitializationMode(fmu), Status::Ok);
            assert_eq!(crate::fmi2ExitInitializationMode(fmu), Status::Ok);
        }
        importer
    }

    fn take(&self) -> Messages {
        std::mem::take(unsafe { &mut *self.messages })
    }

    #[track_caller]
    fn refused(&self, status: Status, part: &str) {
        assert_eq!(status, Status::Error, "expected: {part}");
        let messages = self.take();
        let [(Status::Error, category, message)] = &messages[..] else { panic!("{messages:?}") };
        assert_eq!(category, "logStatusError");
        assert!(message.contains(part), "\"{message}\" lacks \"{part}\"");
    }

    fn set(&self, reference: u32, value: f64) -> Status {
        unsafe { crate::fmi2SetReal(self.instance, &reference, 1, &value) }
    }

    fn get<const N: usize>(&self, references: [u32; N]) -> [f64; N] {
        let mut values = [f64::NAN; N];
        let (references, values_pointer) = (references.as_ptr(), values.as_mut_ptr());
        let status = unsafe { crate::fmi2GetReal(self.instance, references, N, values_pointer) };
        assert_eq!(status, Status::Ok, "{:?}", self.take());
        values
    }

    fn step(&self, from_s: f64, size_s: f64) -> Status {
        unsafe { crate::fmi2DoStep(self.instance, from_s, size_s, 1) }
    }

    fn terminated(&self) -> bool {
        let mut value = 7;
        let status = unsafe { crate::fmi2GetBooleanStatus(self.instance, TERMINATED, &mut value) };
        assert_eq!(status, Status::Ok);
        value != 0
    }

    fn last_successful_time_s(&self) -> f64 {
        let mut value = f64::NAN;
        let kind = LAST_SUCCESSFUL_TIME;
        assert_eq!(
            unsafe { crate::fmi2GetRealStatus(self.instance, kind, &mut value) },
            Status::Ok
        );
        value
    }

    fn serialize(&self) -> Vec<u8> {
        let (mut state, mut size) = (ptr::null_mut(), 0);
        unsafe {
            let fmu = self.instance;
            assert_eq!(crate::fmi2GetFMUstate(fmu, &mut state), Status::Ok);
            assert_eq!(crate::fmi2SerializedFMUstateSize(fmu, state, &mut size), Status::Ok);
            let mut blob = vec![0; size];
            assert_eq!(
                crate::fmi2SerializeFMUstate(fmu, state, blob.as_mut_ptr(), size),
                Status::Ok
            );
            assert_eq!(crate::fmi2FreeFMUstate(fmu, &mut state), Status::Ok);
            blob
        }
    }
}

impl Drop for Fmi2 {
    fn drop(&mut self) {
        unsafe {
            crate::fmi2FreeInstance(self.instance);
            drop(Box::from_raw(self.messages));
        }
    }
}

fn token() -> CString {
    CString::new(fmi_adapter::token(Integrator::INTERFACE, Variant::Fmi2)).unwrap()
}

#[test]
fn both_versions_give_the_same_bits() {
    let resources = Resources::new();
    let (two, three) = (Fmi2::stepping(&resources), Importer::stepping(&resources));
    for n in 0..100 {
        let (time_s, rate) = (f64::from(n) * 0.013, f64::from(n).sin());
        assert_eq!((two.set(RATE_1, rate), three.set(RATE_1, rate)), (Status::Ok, Status::Ok));
        assert_eq!(
            (two.step(time_s, 0.013), three.step(time_s, 0.013).0),
            (Status::Ok, Status::Ok)
        );
        let (two, three) = (two.get(ALL_OUTPUTS), three.get(ALL_OUTPUTS));
        assert_eq!(two.map(f64::to_bits), three.map(f64::to_bits));
    }
}

#[test]
fn the_end_of_the_run_is_discard_with_a_reason_and_the_step_is_complete() {
    let resources = Resources::new();
    let importer = Fmi2::new(&resources);
    unsafe {
        assert_eq!(crate::fmi2SetBoolean(importer.instance, &2, 1, &1), Status::Ok);
        crate::fmi2EnterInitializationMode(importer.instance);
        crate::fmi2ExitInitializationMode(importer.instance);
    }
    assert_eq!(importer.step(0.0, 0.01), Status::Ok);
    assert!(!importer.terminated());
    importer.set(TROUBLE, END);
    assert_eq!(importer.step(0.01, 0.01), Status::Discard);
    assert!(importer.terminated());
    assert_eq!(importer.last_successful_time_s(), 0.02);
    assert_eq!(importer.get([0]), [0.02]);
    assert_eq!(importer.take(), [], "an end is no failure");
    // Other kinds tell of pending steps.
    let mut value = 0;
    assert_eq!(unsafe { crate::fmi2GetStatus(importer.instance, 0, &mut value) }, Status::Discard);

    // Not a whole tick: discarded too, but not the end, and nothing has happened.
    importer.set(TROUBLE, 0.0);
    assert_eq!(importer.step(0.02, 0.01), Status::Ok);
    assert_eq!(importer.step(0.03, 0.0105e-1), Status::Discard);
    assert_eq!((importer.terminated(), importer.last_successful_time_s()), (false, 0.03));
}

#[test]
fn unless_asked_a_run_goes_on_after_its_end() {
    let resources = Resources::new();
    let importer = Fmi2::stepping(&resources);
    let fmu = importer.instance;
    unsafe {
        let mut value = 7;
        assert_eq!(crate::fmi2GetBoolean(fmu, &2, 1, &mut value), Status::Ok);
        assert_eq!(value, 0);
        importer.set(TROUBLE, END);
        assert_eq!(importer.step(0.0, 0.01), Status::Ok);
        let part = "terminate_at_end is a fixed parameter";
        importer.refused(crate::fmi2SetBoolean(fmu, &2, 1, &1), part);
    }
}

#[test]
fn misuse() {
    let resources = Resources::new();
    let importer = Fmi2::stepping(&resources);
    let fmu = importer.instance;
    let null: *mut c_void = ptr::null_mut();
    importer.refused(importer.set(RATE_2, f64::NAN), "fmi2SetReal: rate[2] = NaN");
    importer.refused(importer.set(X_1, 1.0), "x[1] (value reference 2000) is output");
    importer.refused(importer.set(777, 1.0), "value reference 777 is unknown");
    importer.refused(importer.step(5.0, 0.01), "currentCommunicationPoint is 5 s");
    unsafe {
        let mut number = 0;
        let status = crate::fmi2GetInteger(fmu, &X_1, 1, &mut number);
        importer.refused(status, "fmi2GetInteger: x[1] (value reference 2000) is of type Real");
        importer.refused(crate::fmi2GetReal(fmu, &X_1, 1, null.cast()), "values is a null");
        importer.refused(crate::fmi2GetReal(fmu, null.cast(), 1, null.cast()), "is a null");
        importer.refused(crate::fmi2GetFMUstate(fmu, ptr::null_mut()), "FMUState is a null");
        importer.refused(crate::fmi2SetFMUstate(fmu, null), "FMUState is not a state");
        importer.refused(crate::fmi2EnterEventMode(fmu), "fmi2EnterEventMode: not supported");
        importer.refused(crate::fmi2SetTime(fmu, 0.0), "fmi2SetTime: not supported");
        importer.refused(crate::fmi2EnterInitializationMode(fmu), "not allowed in state Step");
        importer.refused(
            crate::fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0),
            "not allowed in state Step",
        );
        assert_eq!(crate::fmi2Reset(null), Status::Error);
        crate::fmi2FreeInstance(null);
    }
    assert_eq!(importer.step(0.0, 0.01), Status::Ok, "a refused call broke the instance");
    importer.set(TROUBLE, PANIC);
    importer.refused(importer.step(0.01, 0.01), "step was told to panic");
    importer.refused(importer.step(0.01, 0.01), "not allowed in state Failed");
    unsafe {
        assert_eq!(crate::fmi2Reset(fmu), Status::Ok);
        assert_eq!(crate::fmi2EnterInitializationMode(fmu), Status::Ok);
        assert_eq!(crate::fmi2ExitInitializationMode(fmu), Status::Ok);
    }
    assert_eq!(importer.step(0.0, 0.01), Status::Ok);
}

#[test]
fn instantiation_is_refused_with_a_reason() {
    let three = CString::new(fmi_adapter::token(Integrator::INTERFACE, Variant::Fmi3)).unwrap();
    for (token, kind, reason) in [
        (c"wrong".as_ptr(), 1, "the token is \"wrong\""),
        (three.as_ptr(), 1, "the token is"),
        (ptr::null(), 1, "fmuGUID is a null pointer"),
        (token().as_ptr(), 0, "fmi2Instantiate: not supported"),
    ] {
        let importer = Fmi2::with(token, ptr::null(), kind);
        assert!(importer.instance.is_null());
        importer.refused(Status::Error, reason);
    }
    // Nobody listens, and nothing breaks.
    let none = ptr::null();
    assert!(unsafe { crate::fmi2Instantiate(none, 1, none, none, ptr::null(), 0, 1) }.is_null());
}

#[test]
fn a_message_is_its_own_format() {
    let resources = Resources::new();
    let importer = Fmi2::new(&resources);
    let value = c"100%s#".as_ptr();
    unsafe {
        assert_eq!(crate::fmi2SetString(importer.instance, &1, 1, &value), Status::Ok);
        let status = crate::fmi2EnterInitializationMode(importer.instance);
        importer.refused(status, "100%%s##: cannot be read");
    }
}

#[test]
fn a_state_of_one_version_continues_in_the_other() {
    let resources = Resources::new();
    let (two, three) = (Fmi2::stepping(&resources), Importer::new(&resources));
    two.set(RATE_1, 3.0);
    two.step(0.0, 0.05);
    let (status, state) = three.deserialize(&two.serialize());
    assert_eq!((status, three.set_state(state)), (Status::Ok, Status::Ok));
    for n in 5..10 {
        let time_s = f64::from(n) * 0.01;
        assert_eq!((two.step(time_s, 0.01), three.step(time_s, 0.01).0), (Status::Ok, Status::Ok));
        let (two, three) = (two.get(ALL_OUTPUTS), three.get(ALL_OUTPUTS));
        assert_eq!(two.map(f64::to_bits), three.map(f64::to_bits));
    }
}
