//! A small importer of our own: what `check` drives an unpacked FMU with, in this process.
//!
//! SAFETY, the same for every `unsafe` below: the library is an FMU's, so its functions have the
//! types of the FMI headers; handles come from its own `instantiate` and are freed once, when the
//! `Instance` is dropped, which cannot outlive the library; all arrays and strings live through the
//! call. The misuse that `check` tries on purpose (null instances, freed states) is what FMI asks
//! of an FMU to refuse, and ours does.

mod functions;

use std::ffi::{CStr, CString};
use std::path::Path;
use std::ptr;
use std::sync::Mutex;

use functions::{
    Callbacks2, Handle, OWN_2, OWN_3, Own2, Own3, SHARED_2, SHARED_3, Shared, TERMINATED, Text,
};

/// A call that was not carried out.
#[derive(Debug)]
pub struct Refusal {
    /// `fmi2Status`, `fmi3Status`: 2 discard, 3 error, 4 fatal.
    pub status: i32,
    /// What the FMU logged.
    pub messages: Vec<String>,
}

pub const DISCARD: i32 = 2;
pub const ERROR: i32 = 3;

pub type Answer<T = ()> = Result<T, Refusal>;

/// An FMU's library, loaded.
pub struct Library {
    shared: Shared,
    own: Own,
    // Last: unloaded when nothing points into it any more.
    _library: libloading::Library,
}

enum Own {
    Two(Own2),
    Three(Own3),
}

impl Library {
    /// Loads `file` and finds the functions of FMI 2.0 or 3.0.
    pub fn load(file: &Path, is_fmi2: bool) -> Result<Self, libloading::Error> {
        let library = unsafe { libloading::Library::new(file)? };
        let (shared, own) = if is_fmi2 {
            (Shared::find(&library, &SHARED_2)?, Own::Two(Own2::find(&library, &OWN_2)?))
        } else {
            (Shared::find(&library, &SHARED_3)?, Own::Three(Own3::find(&library, &OWN_3)?))
        };
        Ok(Self { shared, own, _library: library })
    }

    /// The FMI version that the library names.
    pub fn version(&self) -> String {
        text(unsafe { (self.shared.version)() })
    }

    /// The status of a step that is asked of no instance.
    pub fn step_nothing(&self) -> i32 {
        self.step_handle(ptr::null_mut(), 0.0, 0.01).0
    }

    pub fn instantiate(&self, token: &str, resources: &Path) -> Answer<Instance<'_>> {
        let messages = Box::new(Mutex::new(Vec::new()));
        let environment = (&raw const *messages).cast_mut().cast();
        let callbacks = Box::new(Callbacks2 {
            logger: log2,
            allocate_memory: ptr::null_mut(),
            free_memory: ptr::null_mut(),
            step_finished: ptr::null_mut(),
            environment,
        });
        let folder = resources.to_string_lossy();
        let location = match self.own {
            Own::Two(_) => c_string(&uri(&folder)),
            Own::Three(_) => c_string(&folder),
        };
        let (name, token) = (c"check".as_ptr(), c_string(token));
        let (token, location) = (token.as_ptr(), location.as_ptr());
        let handle = match &self.own {
            Own::Two(own) => unsafe {
                (own.instantiate)(name, 1, token, location, &raw const *callbacks, 0, 0)
            },
            Own::Three(own) => {
                let (create, no_variables, no_update) =
                    (own.instantiate, ptr::null(), ptr::null_mut());
                let (visible, logging, events, early) = (false, false, false, false);
                unsafe {
                    create(
                        name,
                        token,
                        location,
                        visible,
                        logging,
                        events,
                        early,
                        no_variables,
                        0,
                        environment,
                        Some(log3),
                        no_update,
                    )
                }
            }
        };
        let instance = Instance { library: self, handle, messages, _callbacks: callbacks };
        if handle.is_null() { Err(instance.refusal(ERROR)) } else { Ok(instance) }
    }

    /// Status, and whether the run has reached its end.
    fn step_handle(&self, handle: Handle, from_s: f64, size_s: f64) -> (i32, bool) {
        match &self.own {
            Own::Two(own) => {
                let status = unsafe { (own.step)(handle, from_s, size_s, 0) };
                let mut ended = 0;
                if status == DISCARD {
                    unsafe { (own.boolean_status)(handle, TERMINATED, &mut ended) };
                }
                // FMI 2.0 has no other way to say that a completed step was the last.
                if ended == 0 { (status, false) } else { (0, true) }
            }
            Own::Three(own) => {
                let (mut event, mut ended, mut early, mut reached_s) = (false, false, false, 0.0);
                let (event, early, reached_s) = (&mut event, &mut early, &mut reached_s);
                let step = own.step;
                let status = unsafe {
                    step(handle, from_s, size_s, false, event, &mut ended, early, reached_s)
                };
                (status, ended)
            }
        }
    }
}

/// An instance, freed when dropped.
pub struct Instance<'library> {
    library: &'library Library,
    handle: Handle,
    messages: Box<Mutex<Vec<String>>>,
    // FMI 2.0: must live as long as the instance.
    _callbacks: Box<Callbacks2>,
}

/// A stored state of an instance, which frees it in the end unless `free_state` does before.
#[derive(Clone, Copy)]
pub struct State(Handle);

impl Instance<'_> {
    pub fn initialize(&self) -> Answer {
        self.enter_initialization()?;
        self.call(unsafe { (self.library.shared.exit_initialization)(self.handle) })
    }

    pub fn enter_initialization(&self) -> Answer {
        match &self.library.own {
            Own::Two(own) => {
                self.call(unsafe { (own.set_up)(self.handle, 0, 0.0, 0.0, 0, 0.0) })?;
                self.call(unsafe { (own.enter_initialization)(self.handle) })
            }
            Own::Three(own) => self.call(unsafe {
                (own.enter_initialization)(self.handle, false, 0.0, 0.0, false, 0.0)
            }),
        }
    }

    pub fn terminate(&self) -> Answer {
        self.call(unsafe { (self.library.shared.terminate)(self.handle) })
    }

    pub fn reset(&self) -> Answer {
        self.call(unsafe { (self.library.shared.reset)(self.handle) })
    }

    /// True if the FMU asks for the end of the run.
    pub fn step(&self, from_s: f64, size_s: f64) -> Answer<bool> {
        let (status, ended) = self.library.step_handle(self.handle, from_s, size_s);
        self.call(status)?;
        Ok(ended)
    }

    /// The `count` values of all references together.
    pub fn get(&self, references: &[u32], count: usize) -> Answer<Vec<f64>> {
        let mut values = vec![f64::NAN; count];
        let (r, n, v) = (references.as_ptr(), references.len(), values.as_mut_ptr());
        self.call(match &self.library.own {
            Own::Two(own) => unsafe { (own.get)(self.handle, r, n, v) },
            Own::Three(own) => unsafe { (own.get)(self.handle, r, n, v, count) },
        })?;
        Ok(values)
    }

    pub fn set(&self, references: &[u32], values: &[f64]) -> Answer {
        let (r, n, v) = (references.as_ptr(), references.len(), values.as_ptr());
        self.call(match &self.library.own {
            Own::Two(own) => unsafe { (own.set)(self.handle, r, n, v) },
            Own::Three(own) => unsafe { (own.set)(self.handle, r, n, v, values.len()) },
        })
    }

    pub fn set_string(&self, reference: u32, value: &str) -> Answer {
        let value = c_string(value);
        let value = value.as_ptr();
        self.call(match &self.library.own {
            Own::Two(own) => unsafe { (own.set_string)(self.handle, &reference, 1, &value) },
            Own::Three(own) => unsafe { (own.set_string)(self.handle, &reference, 1, &value, 1) },
        })
    }

    pub fn set_boolean(&self, reference: u32, value: bool) -> Answer {
        self.call(match &self.library.own {
            Own::Two(own) => unsafe {
                (own.set_boolean)(self.handle, &reference, 1, &value.into())
            },
            Own::Three(own) => unsafe { (own.set_boolean)(self.handle, &reference, 1, &value, 1) },
        })
    }

    pub fn state(&self) -> Answer<State> {
        let mut state = ptr::null_mut();
        self.call(unsafe { (self.library.shared.get_state)(self.handle, &mut state) })?;
        Ok(State(state))
    }

    pub fn restore(&self, state: State) -> Answer {
        self.call(unsafe { (self.library.shared.set_state)(self.handle, state.0) })
    }

    pub fn free_state(&self, state: State) -> Answer {
        let mut state = state.0;
        self.call(unsafe { (self.library.shared.free_state)(self.handle, &mut state) })
    }

    pub fn serialize(&self, state: State) -> Answer<Vec<u8>> {
        let mut size = 0;
        let shared = &self.library.shared;
        self.call(unsafe { (shared.state_size)(self.handle, state.0, &mut size) })?;
        let mut bytes = vec![0; size];
        let place = bytes.as_mut_ptr();
        self.call(unsafe { (shared.serialize)(self.handle, state.0, place, size) })?;
        Ok(bytes)
    }

    pub fn deserialize(&self, bytes: &[u8]) -> Answer<State> {
        let mut state = ptr::null_mut();
        let (data, size) = (bytes.as_ptr(), bytes.len());
        let deserialize = self.library.shared.deserialize;
        self.call(unsafe { deserialize(self.handle, data, size, &mut state) })?;
        Ok(State(state))
    }

    fn call(&self, status: i32) -> Answer {
        if status == 0 { Ok(()) } else { Err(self.refusal(status)) }
    }

    fn refusal(&self, status: i32) -> Refusal {
        let messages = self.messages.lock().map(|mut list| std::mem::take(&mut *list));
        Refusal { status, messages: messages.unwrap_or_default() }
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        unsafe { (self.library.shared.free)(self.handle) }
    }
}

unsafe extern "C" fn log2(environment: Handle, _name: Text, _status: i32, _: Text, message: Text) {
    note(environment, text(message));
}

unsafe extern "C" fn log3(environment: Handle, _status: i32, _category: Text, message: Text) {
    note(environment, text(message));
}

fn note(environment: Handle, message: String) {
    let list = unsafe { environment.cast::<Mutex<Vec<String>>>().as_ref() };
    // A poisoned list would be that of a thread that is gone.
    if let Some(Ok(mut list)) = list.map(Mutex::lock) {
        list.push(message);
    }
}

/// A file URI; on Windows the path has a drive and backslashes.
fn uri(path: &str) -> String {
    let path = path.replace('\\', "/");
    let root = if path.starts_with('/') { "file://" } else { "file:///" };
    path.bytes().fold(root.to_owned(), |uri, byte| match byte {
        b'/' | b'-' | b'.' | b'_' | b'~' | b':' => uri + &char::from(byte).to_string(),
        _ if byte.is_ascii_alphanumeric() => uri + &char::from(byte).to_string(),
        _ => format!("{uri}%{byte:02X}"),
    })
}

fn text(text: Text) -> String {
    let text = if text.is_null() { c"" } else { unsafe { CStr::from_ptr(text) } };
    text.to_string_lossy().into_owned()
}

/// Nothing that `check` passes holds a NUL; were there one, an empty text would be refused.
fn c_string(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}
