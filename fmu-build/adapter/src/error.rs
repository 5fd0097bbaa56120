//! Why a call was refused or failed. The message reaches the importer's logger.

use lander_models::ModelError;
use lander_models::time::NotWholeTicks;

use crate::snapshot::BlobError;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("not allowed in state {state}")]
    NotAllowed { state: &'static str },
    #[error("not supported: modelDescription.xml does not declare this capability")]
    Unsupported,
    #[error("{what} is a null pointer")]
    Null { what: &'static str },
    #[error("{what} is not valid UTF-8")]
    NotUtf8 { what: String },

    #[error("the token is \"{given}\", this library has \"{expected}\"")]
    Token { given: String, expected: String },
    #[error("eventModeUsed was false at instantiation")]
    EventModeUnused,
    #[error("log category \"{0}\" is unknown")]
    LogCategory(String),

    #[error("value reference {0} is unknown")]
    UnknownReference(u32),
    #[error("{name} (value reference {reference}) is of type {actual}, not {asked}")]
    WrongType { name: String, reference: u32, actual: &'static str, asked: &'static str },
    #[error("{name} (value reference {reference}) is {causality}: it can't be set")]
    NotSettable { name: String, reference: u32, causality: &'static str },
    #[error("{name} is a fixed parameter: it can't be set in state {state}")]
    Fixed { name: String, state: &'static str },
    #[error("{name} is an output: it has no value in state {state}")]
    NoValue { name: String, state: &'static str },
    #[error("{name} = {value}: inputs must be finite")]
    NotFinite { name: String, value: f64 },
    #[error("{name} = {value}: must be within {least:e} and {greatest:e}")]
    OutOfRange { name: String, value: f64, least: f64, greatest: f64 },
    #[error("nValues is {given}, but {names} need {expected}")]
    Length { names: String, given: usize, expected: usize },

    #[error("startTime is {0} s: this model starts at 0 s")]
    StartTime(f64),
    #[error("stopTime is {0} s: it must be greater than 0")]
    StopTime(f64),
    #[error("communicationStepSize is {0} s: it must be greater than 0")]
    NoStep(f64),
    #[error("communicationStepSize: {0}")]
    StepSize(NotWholeTicks),
    #[error("currentCommunicationPoint is {given} s, but the instance is at {now} s")]
    CommunicationPoint { given: f64, now: f64 },
    #[error("the step from {from} s to {to} s passes the stop time")]
    PassesStop { from: f64, to: f64 },

    #[error("scenario_file \"{parameter}\" is relative, but the importer gave no resource path")]
    NoResources { parameter: String },
    /// The model's message names the file.
    #[error(transparent)]
    Create(ModelError),
    #[error("the model failed: {0}")]
    Step(#[source] ModelError),
    #[error("internal error: {0}; only reset, set state and free can follow")]
    Panic(String),

    #[error("status kind {0} tells nothing here: no step is ever pending")]
    StatusKind(i32),

    #[error("FMUState is not a state of this instance, or was freed")]
    UnknownState,
    #[error("serializedState: {0}")]
    Blob(#[from] BlobError),
    #[error("size is {given}, the serialised state has {expected} bytes")]
    BlobSize { given: usize, expected: usize },
}

impl Error {
    /// Whether nothing is wrong but the arguments' values: the importer may try others.
    pub(crate) fn is_discard(&self) -> bool {
        matches!(self, Self::StepSize(_) | Self::StatusKind(_))
    }
}
