//! Reading and writing variables: every check is made before the first value is written.

use std::ffi::{CStr, CString};

use lander_models::Component;

use crate::error::Error;
use crate::instance::Instance;
use crate::lifecycle::Lifecycle;
use crate::variables::Slot;

impl<C: Component> Instance<C> {
    pub fn get_floats(&self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        let slots = find::<C>(references, "Float64", values.len())?;
        for (slot, value) in slots.into_iter().zip(values) {
            *value = match slot {
                Slot::Input(index) => self.live.inputs[index],
                Slot::Output(index) => self.outputs[index],
                Slot::Time | Slot::Scenario => self.now_s(),
            };
        }
        Ok(())
    }

    pub fn set_floats(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        let slots = find::<C>(references, "Float64", values.len())?;
        let mut targets = Vec::with_capacity(slots.len());
        for ((&reference, slot), &value) in references.iter().zip(slots).zip(values) {
            let name = || slot.name(C::INTERFACE);
            let Slot::Input(index) = slot else {
                let causality = slot.causality();
                return Err(Error::NotSettable { name: name(), reference, causality });
            };
            if !value.is_finite() {
                return Err(Error::NotFinite { name: name(), value });
            }
            targets.push((index, value));
        }
        for (index, value) in targets {
            self.live.inputs[index] = value;
        }
        Ok(())
    }

    /// The strings live in the instance until it is changed or freed.
    pub fn get_strings(&self, references: &[u32], count: usize) -> Result<Vec<&CStr>, Error> {
        let slots = find::<C>(references, "String", count)?;
        Ok(slots.iter().map(|_| self.live.scenario_file.as_c_str()).collect())
    }

    /// The one string is the scenario. In Initialization Mode FMI still lets it be set: then
    /// the component is created anew.
    pub fn set_strings(&mut self, references: &[u32], values: &[&CStr]) -> Result<(), Error> {
        let slots = find::<C>(references, "String", values.len())?;
        let (Some(slot), Some(value)) = (slots.last(), values.last()) else { return Ok(()) };
        let name = slot.name(C::INTERFACE);
        let state = self.live.lifecycle;
        if state == Lifecycle::Stepping {
            return Err(Error::Fixed { name, state: state.name() });
        }
        if value.to_str().is_err() {
            return Err(Error::NotUtf8 { what: name });
        }
        let before = std::mem::replace(&mut self.live.scenario_file, CString::from(*value));
        if state == Lifecycle::Initialization {
            self.create().inspect_err(|_| self.live.scenario_file = before)?;
        }
        Ok(())
    }

    /// The answer to a typed access for a type that no variable has.
    pub fn refuse_type(&self, references: &[u32], asked: &'static str) -> Result<(), Error> {
        find::<C>(references, asked, references.len()).map(|_| ())
    }
}

fn find<C: Component>(
    references: &[u32],
    asked: &'static str,
    value_count: usize,
) -> Result<Vec<Slot>, Error> {
    let find_one = |&reference: &u32| {
        let slot = Slot::find(C::INTERFACE, reference).ok_or(Error::UnknownReference(reference))?;
        if slot.data_type() == asked {
            Ok(slot)
        } else {
            let (name, actual) = (slot.name(C::INTERFACE), slot.data_type());
            Err(Error::WrongType { name, reference, actual, asked })
        }
    };
    let slots: Vec<Slot> = references.iter().map(find_one).collect::<Result<_, _>>()?;
    if value_count != references.len() {
        let first = slots.first().map_or("no variable".to_owned(), |s| s.name(C::INTERFACE));
        let names = match references.len() {
            0 | 1 => first,
            n => format!("{first} and {} more", n - 1),
        };
        return Err(Error::Length { names, given: value_count, expected: references.len() });
    }
    Ok(slots)
}
