//! Messages to the importer. Failures are always sent; events only while debug logging asks.

use crate::Error;

/// Log categories as declared in modelDescription.xml.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    Error,
    Discard,
    Event,
}

impl Category {
    pub const ALL: [Self; 3] = [Self::Error, Self::Discard, Self::Event];

    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "logStatusError",
            Self::Discard => "logStatusDiscard",
            Self::Event => "logEvents",
        }
    }

    pub fn description(self) -> &'static str {
        match self {
            Self::Error => "Why a call returned an error; always sent",
            Self::Discard => "Why a step was discarded; always sent",
            Self::Event => "Scenario loaded, touchdown and other events, end of the run",
        }
    }
}

/// Carries a message to the importer's callback.
pub type Sink = Box<dyn Fn(Category, &str)>;

#[derive(Default)]
pub struct Logger {
    sink: Option<Sink>,
    events: bool,
    events_at_first: bool,
}

impl Logger {
    /// Without a sink (the importer passed no callback) messages are dropped.
    pub fn new(sink: Option<Sink>, debug_logging: bool) -> Self {
        Self { sink, events: debug_logging, events_at_first: debug_logging }
    }

    /// Switches debug logging: on for the listed categories only, or off for them. An empty
    /// list means all.
    pub fn select(&mut self, on: bool, categories: &[&str]) -> Result<(), Error> {
        let known = |name: &&&str| Category::ALL.iter().any(|category| category.name() == **name);
        if let Some(unknown) = categories.iter().find(|name| !known(name)) {
            return Err(Error::LogCategory((*unknown).to_owned()));
        }
        let listed = categories.is_empty() || categories.contains(&Category::Event.name());
        self.events = if on { listed } else { self.events && !listed };
        Ok(())
    }

    /// Back to the debug logging that `new` was given.
    pub fn reset(&mut self) {
        self.events = self.events_at_first;
    }

    pub fn error(&self, message: &str) {
        self.send(Category::Error, message);
    }

    pub fn discard(&self, message: &str) {
        self.send(Category::Discard, message);
    }

    pub fn event(&self, message: &str) {
        if self.events {
            self.send(Category::Event, message);
        }
    }

    fn send(&self, category: Category, message: &str) {
        if let Some(sink) = &self.sink {
            sink(category, message);
        }
    }
}
