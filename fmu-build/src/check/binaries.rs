//! The libraries in an archive: which platforms, with which symbols, and what they need there.

use std::collections::BTreeMap;

use fmi_adapter::Variant;
use lander_models::signals::Interface;

use super::archive::Entries;
use crate::model::library_entry;
use crate::platform::{Glibc, Library, Platform};

/// Functions of the headers that importers look up, each after `fmi2` or `fmi3`.
const FMI2: &str = "GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance \
    SetupExperiment EnterInitializationMode ExitInitializationMode Terminate Reset GetReal \
    GetInteger GetBoolean GetString SetReal SetInteger SetBoolean SetString GetFMUstate \
    SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate \
    GetDirectionalDerivative SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep \
    GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus EnterEventMode \
    NewDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep SetTime \
    SetContinuousStates GetDerivatives GetEventIndicators GetContinuousStates \
    GetNominalsOfContinuousStates";
const FMI3: &str = "GetVersion SetDebugLogging InstantiateModelExchange InstantiateCoSimulation \
    InstantiateScheduledExecution FreeInstance EnterInitializationMode ExitInitializationMode \
    EnterEventMode Terminate Reset GetFloat32 GetFloat64 GetInt8 GetUInt8 GetInt16 GetUInt16 \
    GetInt32 GetUInt32 GetInt64 GetUInt64 GetBoolean GetString GetBinary GetClock SetFloat32 \
    SetFloat64 SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 SetInt64 SetUInt64 \
    SetBoolean SetString SetBinary SetClock GetNumberOfVariableDependencies \
    GetVariableDependencies GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize \
    SerializeFMUState DeserializeFMUState GetDirectionalDerivative GetAdjointDerivative \
    EnterConfigurationMode ExitConfigurationMode GetIntervalDecimal GetIntervalFraction \
    GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal \
    SetShiftFraction EvaluateDiscreteStates UpdateDiscreteStates EnterContinuousTimeMode \
    CompletedIntegratorStep SetTime SetContinuousStates GetContinuousStateDerivatives \
    GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates \
    GetNumberOfEventIndicators GetNumberOfContinuousStates EnterStepMode GetOutputDerivatives \
    DoStep ActivateModelPartition";

/// What is asked of the libraries.
#[derive(Clone, Debug, Default)]
pub struct Demands {
    /// The newest glibc that may be needed.
    pub glibc: Option<Glibc>,
    /// At least these.
    pub platforms: Vec<Platform>,
}

/// The libraries by platform, as far as they are what they should be, and the problems.
pub fn read(
    model: &Interface,
    variant: Variant,
    entries: &Entries,
    demands: &Demands,
) -> (BTreeMap<Platform, Library>, Vec<String>) {
    let mut libraries = BTreeMap::new();
    let mut problems = Vec::new();
    for platform in Platform::ALL {
        let path = library_entry(model, variant, platform);
        match entries.get(&path).map(|bytes| Library::read(bytes)) {
            None if demands.platforms.contains(&platform) => {
                problems.push(format!("{path} is missing"));
            }
            None => {}
            Some(Err(reason)) => problems.push(format!("{path} {reason}")),
            Some(Ok(library)) => {
                let found = library_problems(&library, platform, variant, demands);
                problems.extend(found.into_iter().map(|problem| format!("{path} {problem}")));
                libraries.insert(platform, library);
            }
        }
    }
    let known = |path: &str| {
        Platform::ALL.map(|p| library_entry(model, variant, p)).contains(&path.to_owned())
    };
    let others = entries.keys().filter(|path| path.starts_with("binaries/") && !known(path));
    problems.extend(others.map(|path| format!("{path} is not where an importer looks")));
    if libraries.is_empty() && problems.is_empty() {
        problems.push("there is no library for any platform".to_owned());
    }
    (libraries, problems)
}

fn library_problems(
    library: &Library,
    platform: Platform,
    variant: Variant,
    demands: &Demands,
) -> Vec<String> {
    let mut problems = Vec::new();
    if library.platform != platform {
        problems.push(format!("is for {}", library.platform.name()));
    }
    let (prefix, names) = if variant == Variant::Fmi2 { ("fmi2", FMI2) } else { ("fmi3", FMI3) };
    let symbols = names.split_whitespace().map(|name| format!("{prefix}{name}"));
    let missing: Vec<_> = symbols.filter(|symbol| !library.exports.contains(symbol)).collect();
    if !missing.is_empty() {
        problems.push(format!("does not export {}", missing.join(", ")));
    }
    let foreign = library.foreign_needs();
    if !foreign.is_empty() {
        problems.push(format!("needs more than the system: {}", foreign.join(", ")));
    }
    if let (Some(needed), Some(limit)) = (library.glibc, demands.glibc)
        && needed > limit
    {
        problems.push(format!("needs {}, above {}", shown(needed), shown(limit)));
    }
    problems
}

/// `x86_64-linux (glibc 2.14)`.
pub fn summary(libraries: &BTreeMap<Platform, Library>) -> String {
    let one = |library: &Library| match library.glibc {
        Some(glibc) => format!("{} ({})", library.platform.name(), shown(glibc)),
        None => library.platform.name().to_owned(),
    };
    libraries.values().map(one).collect::<Vec<_>>().join(", ")
}

fn shown((major, minor): Glibc) -> String {
    format!("glibc {major}.{minor}")
}
