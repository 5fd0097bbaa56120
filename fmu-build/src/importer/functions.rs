//! The C functions of a library, found by their names; FMI 2.0 and 3.0 share what they can.

use std::ffi::{c_char, c_int, c_void};

pub(super) type Handle = *mut c_void;
pub(super) type Text = *const c_char;
/// `fmi2Status`, `fmi3Status`, as a number: a foreign library may return any.
pub(super) type Status = c_int;

/// `fmi2StatusKind`: the run has reached its end.
pub(super) const TERMINATED: c_int = 3;

/// `fmi2CallbackFunctions`. The logger is variadic in C; Rust can neither define nor name one, and
/// on the platforms of this kit a call of it passes the first five arguments alike.
#[repr(C)]
pub(super) struct Callbacks2 {
    pub logger: unsafe extern "C" fn(Handle, Text, Status, Text, Text),
    pub allocate_memory: Handle,
    pub free_memory: Handle,
    pub step_finished: Handle,
    pub environment: Handle,
}

pub(super) type Log3 = unsafe extern "C" fn(Handle, Status, Text, Text);

/// Declares a struct of functions and how it is found in a library.
macro_rules! functions {
    ($(#[$doc:meta])* $name:ident { $($field:ident($($argument:ty),*) $(-> $result:ty)? ;)* }) => {
        $(#[$doc])*
        pub(super) struct $name {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl $name {
            /// `symbols` in the order of the fields.
            pub fn find(
                library: &libloading::Library,
                symbols: &[&'static str],
            ) -> Result<Self, libloading::Error> {
                let mut symbols = symbols.iter();
                Ok(Self {
                    // SAFETY: the types are those of the FMI headers, in the order of the names;
                    // `Library` keeps the library loaded as long as the pointers live.
                    $($field: unsafe { *library.get(*symbols.next().unwrap_or(&"")) ? },)*
                })
            }
        }
    };
}

functions! {
    /// With equal arguments in both versions.
    Shared {
        version() -> Text;
        free(Handle);
        exit_initialization(Handle) -> Status;
        terminate(Handle) -> Status;
        reset(Handle) -> Status;
        get_state(Handle, *mut Handle) -> Status;
        set_state(Handle, Handle) -> Status;
        free_state(Handle, *mut Handle) -> Status;
        state_size(Handle, Handle, *mut usize) -> Status;
        serialize(Handle, Handle, *mut u8, usize) -> Status;
        deserialize(Handle, *const u8, usize, *mut Handle) -> Status;
    }
}

pub(super) const SHARED_2: [&str; 11] = [
    "fmi2GetVersion",
    "fmi2FreeInstance",
    "fmi2ExitInitializationMode",
    "fmi2Terminate",
    "fmi2Reset",
    "fmi2GetFMUstate",
    "fmi2SetFMUstate",
    "fmi2FreeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SerializeFMUstate",
    "fmi2DeSerializeFMUstate",
];

pub(super) const SHARED_3: [&str; 11] = [
    "fmi3GetVersion",
    "fmi3FreeInstance",
    "fmi3ExitInitializationMode",
    "fmi3Terminate",
    "fmi3Reset",
    "fmi3GetFMUState",
    "fmi3SetFMUState",
    "fmi3FreeFMUState",
    "fmi3SerializedFMUStateSize",
    "fmi3SerializeFMUState",
    "fmi3DeserializeFMUState",
];

functions! {
    Own2 {
        instantiate(Text, c_int, Text, Text, *const Callbacks2, c_int, c_int) -> Handle;
        set_up(Handle, c_int, f64, f64, c_int, f64) -> Status;
        enter_initialization(Handle) -> Status;
        get(Handle, *const u32, usize, *mut f64) -> Status;
        set(Handle, *const u32, usize, *const f64) -> Status;
        set_string(Handle, *const u32, usize, *const Text) -> Status;
        set_boolean(Handle, *const u32, usize, *const c_int) -> Status;
        step(Handle, f64, f64, c_int) -> Status;
        boolean_status(Handle, c_int, *mut c_int) -> Status;
    }
}

pub(super) const OWN_2: [&str; 9] = [
    "fmi2Instantiate",
    "fmi2SetupExperiment",
    "fmi2EnterInitializationMode",
    "fmi2GetReal",
    "fmi2SetReal",
    "fmi2SetString",
    "fmi2SetBoolean",
    "fmi2DoStep",
    "fmi2GetBooleanStatus",
];

functions! {
    Own3 {
        instantiate(
            Text, Text, Text, bool, bool, bool, bool, *const u32, usize, Handle, Option<Log3>, Handle
        ) -> Handle;
        enter_initialization(Handle, bool, f64, f64, bool, f64) -> Status;
        get(Handle, *const u32, usize, *mut f64, usize) -> Status;
        set(Handle, *const u32, usize, *const f64, usize) -> Status;
        set_string(Handle, *const u32, usize, *const Text, usize) -> Status;
        set_boolean(Handle, *const u32, usize, *const bool, usize) -> Status;
        step(Handle, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> Status;
    }
}

pub(super) const OWN_3: [&str; 7] = [
    "fmi3InstantiateCoSimulation",
    "fmi3EnterInitializationMode",
    "fmi3GetFloat64",
    "fmi3SetFloat64",
    "fmi3SetString",
    "fmi3SetBoolean",
    "fmi3DoStep",
];
