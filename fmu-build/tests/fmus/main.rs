//! FMUs around stand-in libraries: packed, looked into and run.

mod check;
mod package;
mod workshop;
