//! An importer in a few lines: owns an instance, collects its messages.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::PathBuf;
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};

use fmi_adapter::Variant;
use fmi_adapter::fmi3::{Events, Status};
use lander_models::Component;

use crate::integrator::Integrator;

/// A resources folder with `scenarios/landing.toml` (gain 2) and `scenarios/other.toml` (gain 3).
pub struct Resources(pub PathBuf);

impl Resources {
    pub fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let folder = format!("fmi-adapter-test-{}-{number}", std::process::id());
        let resources = Self(std::env::temp_dir().join(folder));
        std::fs::create_dir_all(resources.0.join("scenarios")).unwrap();
        resources.write("landing", "2");
        resources.write("other", "3");
        resources
    }

    pub fn write(&self, name: &str, content: &str) {
        std::fs::write(self.0.join(format!("scenarios/{name}.toml")), content).unwrap();
    }
}

impl Drop for Resources {
    fn drop(&mut self) {
        // Left-overs in the temporary folder don't make a test wrong.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub type Messages = Vec<(Status, String, String)>;

pub unsafe extern "C" fn collect(
    environment: *mut c_void,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    let text = |text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    let messages = unsafe { &mut *environment.cast::<Messages>() };
    messages.push((status, text(category), text(message)));
}

pub fn token() -> CString {
    CString::new(fmi_adapter::token(Integrator::INTERFACE, Variant::Fmi3)).unwrap()
}

pub struct Importer {
    pub instance: *mut c_void,
    messages: *mut Messages,
}

impl Importer {
    pub fn new(resources: &Resources) -> Self {
        let path = CString::new(resources.0.to_str().unwrap()).unwrap();
        let importer = Self::with(Some(&token()), Some(&path), Events::Unheard);
        assert!(!importer.instance.is_null());
        importer
    }

    pub fn with(token: Option<&CStr>, resources: Option<&CStr>, events: Events) -> Self {
        let messages = Box::into_raw(Box::new(Messages::new()));
        let pointer = |text: Option<&CStr>| text.map_or(ptr::null(), CStr::as_ptr);
        let instance = unsafe {
            crate::fmi3InstantiateCoSimulation(
                c"test".as_ptr(),
                pointer(token),
                pointer(resources),
                false,
                false,
                events != Events::Unheard,
                events == Events::ReturnEarly,
                ptr::null(),
                0,
                messages.cast(),
                Some(collect),
                ptr::null_mut(),
            )
        };
        Self { instance, messages }
    }

    /// An importer that handles events.
    pub fn hearing(resources: &Resources, events: Events) -> Self {
        let path = CString::new(resources.0.to_str().unwrap()).unwrap();
        Self::with(Some(&token()), Some(&path), events)
    }

    /// In Step Mode, under the default scenario.
    pub fn stepping(resources: &Resources) -> Self {
        let importer = Self::new(resources);
        importer.start();
        importer
    }

    pub fn start(&self) {
        assert_eq!(self.enter(), Status::Ok, "{:?}", self.take());
        assert_eq!(unsafe { crate::fmi3ExitInitializationMode(self.instance) }, Status::Ok);
    }

    pub fn enter(&self) -> Status {
        unsafe {
            crate::fmi3EnterInitializationMode(self.instance, false, 0.0, 0.0, false, f64::NAN)
        }
    }

    /// Messages since the last call.
    pub fn take(&self) -> Messages {
        std::mem::take(unsafe { &mut *self.messages })
    }

    /// Asserts that `status` is an error with exactly one message, which contains `part`.
    #[track_caller]
    pub fn refused(&self, status: Status, part: &str) {
        self.unsuccessful(status, (Status::Error, "logStatusError"), part);
    }

    /// As `refused`, for a discarded step.
    #[track_caller]
    pub fn discarded(&self, status: Status, part: &str) {
        self.unsuccessful(status, (Status::Discard, "logStatusDiscard"), part);
    }

    #[track_caller]
    fn unsuccessful(&self, status: Status, expected: (Status, &str), part: &str) {
        assert_eq!(status, expected.0, "expected: {part}");
        let messages = self.take();
        let [(level, category, message)] = &messages[..] else { panic!("{messages:?}") };
        assert_eq!((*level, category.as_str()), expected);
        assert!(message.contains(part), "\"{message}\" lacks \"{part}\"");
    }

    pub fn set(&self, reference: u32, value: f64) -> Status {
        unsafe { crate::fmi3SetFloat64(self.instance, &reference, 1, &value, 1) }
    }

    pub fn set_scenario(&self, value: &str) -> Status {
        let value = CString::new(value).unwrap();
        unsafe { crate::fmi3SetString(self.instance, &1, 1, &value.as_ptr(), 1) }
    }

    pub fn set_changes(&self, value: &str) -> Status {
        let value = CString::new(value).unwrap();
        unsafe { crate::fmi3SetString(self.instance, &3, 1, &value.as_ptr(), 1) }
    }

    pub fn scenario(&self) -> String {
        let mut value = ptr::null();
        let status = unsafe { crate::fmi3GetString(self.instance, &1, 1, &mut value, 1) };
        assert_eq!(status, Status::Ok);
        unsafe { CStr::from_ptr(value) }.to_str().unwrap().to_owned()
    }

    pub fn set_terminate_at_end(&self) -> Status {
        unsafe { crate::fmi3SetBoolean(self.instance, &2, 1, &1, 1) }
    }

    pub fn try_get(&self, references: &[u32], values: &mut [f64]) -> Status {
        let (r, v) = (references.as_ptr(), values.as_mut_ptr());
        unsafe { crate::fmi3GetFloat64(self.instance, r, references.len(), v, values.len()) }
    }

    #[track_caller]
    pub fn get<const N: usize>(&self, references: [u32; N]) -> [f64; N] {
        let mut values = [f64::NAN; N];
        let status = self.try_get(&references, &mut values);
        assert_eq!(status, Status::Ok, "{:?}", self.take());
        values
    }

    /// (status, event handling needed, terminate, early return, last successful time)
    pub fn step(&self, from_s: f64, size_s: f64) -> (Status, bool, bool, bool, f64) {
        let (mut event, mut end, mut early, mut time) = (true, true, true, f64::NAN);
        let status = unsafe {
            crate::fmi3DoStep(
                self.instance,
                from_s,
                size_s,
                false,
                &mut event,
                &mut end,
                &mut early,
                &mut time,
            )
        };
        (status, event, end, early, time)
    }

    pub fn get_state(&self) -> *mut c_void {
        let mut state = ptr::null_mut();
        let status = unsafe { crate::fmi3GetFMUState(self.instance, &mut state) };
        assert_eq!(status, Status::Ok, "{:?}", self.take());
        state
    }

    pub fn set_state(&self, state: *mut c_void) -> Status {
        unsafe { crate::fmi3SetFMUState(self.instance, state) }
    }

    pub fn serialize(&self, state: *mut c_void) -> Vec<u8> {
        let mut size = 0;
        let status = unsafe { crate::fmi3SerializedFMUStateSize(self.instance, state, &mut size) };
        assert_eq!(status, Status::Ok, "{:?}", self.take());
        let mut blob = vec![0; size];
        let status =
            unsafe { crate::fmi3SerializeFMUState(self.instance, state, blob.as_mut_ptr(), size) };
        assert_eq!(status, Status::Ok, "{:?}", self.take());
        blob
    }

    pub fn deserialize(&self, blob: &[u8]) -> (Status, *mut c_void) {
        let mut state = ptr::null_mut();
        let (bytes, size) = (blob.as_ptr(), blob.len());
        let status =
            unsafe { crate::fmi3DeserializeFMUState(self.instance, bytes, size, &mut state) };
        (status, state)
    }
}

impl Drop for Importer {
    fn drop(&mut self) {
        unsafe {
            crate::fmi3FreeInstance(self.instance);
            drop(Box::from_raw(self.messages));
        }
    }
}
