//! Reading and writing variables: every check is made before the first value is written, those
//! of references, type and count before the values are so much as looked at.

use std::ffi::CStr;

use lander_models::Component;

use crate::error::Error;
use crate::instance::Instance;
use crate::lifecycle::Lifecycle;
use crate::variables::Slot;

impl<C: Component> Instance<C> {
    /// What `get_reals` and `set_reals` access.
    pub fn real_type(&self) -> &'static str {
        self.variant.real_type()
    }

    /// The scalars that a call accesses as type `asked`, with one value for each.
    pub fn slots(
        &self,
        references: &[u32],
        asked: &'static str,
        value_count: usize,
    ) -> Result<Vec<Slot>, Error> {
        let mut slots = Vec::with_capacity(value_count.min(C::INTERFACE.output_len()));
        for &reference in references {
            let (slot, size) = Slot::find(C::INTERFACE, self.variant, reference)
                .ok_or(Error::UnknownReference(reference))?;
            let actual = slot.data_type(self.variant);
            if actual != asked {
                let name = slot.name(C::INTERFACE);
                return Err(Error::WrongType { name, reference, actual, asked });
            }
            slots.extend(slot.run(size));
        }
        if value_count != slots.len() {
            let first = slots.first().map_or("no variable".to_owned(), |s| s.name(C::INTERFACE));
            let names = match slots.len() {
                0 | 1 => first,
                n => format!("{first} and {} more", n - 1),
            };
            return Err(Error::Length { names, given: value_count, expected: slots.len() });
        }
        Ok(slots)
    }

    /// `slots` come from [`Self::slots`], as in all functions here. Before Initialization Mode
    /// there are start values only.
    pub fn get_floats(&self, slots: &[Slot], values: &mut [f64]) -> Result<(), Error> {
        let state = self.live.lifecycle;
        let is_output = |slot: &&Slot| matches!(slot, Slot::Output(_));
        if state == Lifecycle::Instantiated
            && let Some(output) = slots.iter().find(is_output)
        {
            return Err(Error::NoValue { name: output.name(C::INTERFACE), state: state.name() });
        }
        for (&slot, value) in slots.iter().zip(values) {
            *value = match slot {
                Slot::Input(index) => self.live.inputs[index],
                Slot::Output(index) => self.outputs[index],
                Slot::Time | Slot::Scenario | Slot::TerminateAtEnd | Slot::Changes => self.now_s(),
            };
        }
        Ok(())
    }

    pub fn set_floats(&mut self, slots: &[Slot], values: &[f64]) -> Result<(), Error> {
        let mut targets = Vec::with_capacity(slots.len());
        for (&slot, &value) in slots.iter().zip(values) {
            let name = || slot.name(C::INTERFACE);
            let Slot::Input(index) = slot else {
                let (reference, causality) = (slot.reference(), slot.causality());
                return Err(Error::NotSettable { name: name(), reference, causality });
            };
            if !value.is_finite() {
                return Err(Error::NotFinite { name: name(), value });
            }
            let (least, greatest) = self.input_ranges[index];
            if !(least..=greatest).contains(&value) {
                return Err(Error::OutOfRange { name: name(), value, least, greatest });
            }
            targets.push((index, value));
        }
        for (index, value) in targets {
            self.live.inputs[index] = value;
        }
        Ok(())
    }

    /// The strings live in the instance until it is changed or freed.
    pub fn get_strings(&self, slots: &[Slot]) -> Vec<&CStr> {
        slots.iter().map(|slot| self.live.parameters.text(*slot)).collect()
    }

    /// In Initialization Mode FMI still lets a parameter be set: then the component is created
    /// anew.
    pub fn set_strings(&mut self, slots: &[Slot], values: &[&CStr]) -> Result<(), Error> {
        for (slot, value) in slots.iter().zip(values) {
            self.not_fixed(*slot)?;
            if value.to_str().is_err() {
                return Err(Error::NotUtf8 { what: slot.name(C::INTERFACE) });
            }
        }
        let before = self.live.parameters.clone();
        for (slot, value) in slots.iter().zip(values) {
            self.live.parameters.set_text(*slot, value);
        }
        if self.live.lifecycle == Lifecycle::Initialization && !slots.is_empty() {
            self.create().inspect_err(|_| self.live.parameters = before)?;
        }
        Ok(())
    }

    /// The one Boolean is `terminate_at_end`.
    pub fn get_booleans(&self, slots: &[Slot]) -> Vec<bool> {
        vec![self.live.parameters.terminate_at_end; slots.len()]
    }

    pub fn set_booleans(&mut self, slots: &[Slot], values: &[bool]) -> Result<(), Error> {
        if let (Some(slot), Some(value)) = (slots.last(), values.last()) {
            self.not_fixed(*slot)?;
            self.live.parameters.terminate_at_end = *value;
        }
        Ok(())
    }

    /// Parameters can be set until Initialization Mode is left.
    fn not_fixed(&self, slot: Slot) -> Result<(), Error> {
        match self.live.lifecycle {
            Lifecycle::Instantiated | Lifecycle::Initialization => Ok(()),
            state => Err(Error::Fixed { name: slot.name(C::INTERFACE), state: state.name() }),
        }
    }
}
