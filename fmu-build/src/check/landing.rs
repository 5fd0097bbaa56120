//! Truth and guidance of one variant, coupled: the whole default landing in the kit's own order
//! (cosim-tests/schedule.toml), with the digest that its masters give.

use fmi_adapter::variables::{Slot, TERMINATE_REFERENCE, hex};
use fmi_adapter::{Variable, Variant, variables};
use lander_models::outcome::Outcome;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use sha2::{Digest, Sha256};

use super::drive::{STEP_S, done, time_s};
use super::{Finding, Unpacked};
use crate::importer::{Instance, Library};

/// No scenario of the kit lasts longer, s.
const LONGEST_S: f64 = 600.0;

/// Truth and guidance of the same variant among `fmus`.
pub fn pairs(fmus: &[Unpacked]) -> Vec<(&Unpacked, &Unpacked)> {
    let of = |model: &Interface, variant: Variant| {
        fmus.iter().find(|fmu| fmu.model.model == model.model && fmu.variant == variant)
    };
    Variant::ALL.into_iter().filter_map(|v| Some((of(&TRUTH, v)?, of(&GUIDANCE, v)?))).collect()
}

/// Flies the pair to the end that truth asks for.
pub fn fly(truth: &Unpacked, guidance: &Unpacked) -> Finding {
    Finding::of("landing", landing(truth, guidance))
}

fn landing(truth: &Unpacked, guidance: &Unpacked) -> Result<String, String> {
    let load = |fmu: &Unpacked| Library::load(&fmu.library, fmu.is_fmi2());
    let truth_library = load(truth).map_err(|error| error.to_string())?;
    let guidance_library = load(guidance).map_err(|error| error.to_string())?;
    let (plant, pilot) = (start(&truth_library, truth)?, start(&guidance_library, guidance)?);
    let readings = Wire::between(truth, guidance);
    let commands = Wire::between(guidance, truth);
    let columns = [Wire::outputs(truth), Wire::outputs(guidance)];
    let row = |number: u32| -> Result<Vec<f64>, String> {
        let mut row = vec![time_s(number)];
        row.extend(columns[0].read(&plant)?);
        row.extend(columns[1].read(&pilot)?);
        Ok(row)
    };
    let mut digest = Sha256::new();
    let mut add = |row: &[f64]| row.iter().for_each(|value| digest.update(value.to_le_bytes()));
    add(&row(0)?);
    for number in 0.. {
        let (from_s, to_s) = (time_s(number), time_s(number + 1));
        readings.carry(&plant, &pilot)?;
        let pilot_ended = done("a step of guidance", pilot.step(from_s, STEP_S))?;
        commands.carry(&pilot, &plant)?;
        let plant_ended = done("a step of truth", plant.step(from_s, STEP_S))?;
        let row = row(number + 1)?;
        add(&row);
        if pilot_ended || plant_ended {
            let outcome = outcome(truth, &row);
            let digest = hex(&digest.finalize());
            let name = truth.variant.name();
            return Ok(format!("{name}: {outcome} at {to_s} s, digest {digest}"));
        }
        if to_s > LONGEST_S {
            return Err(format!("no end after {LONGEST_S} s"));
        }
    }
    Err("too many steps".to_owned())
}

/// In Step Mode, to ask for the end of the run.
fn start<'a>(library: &'a Library, fmu: &Unpacked) -> Result<Instance<'a>, String> {
    let created = library.instantiate(&fmu.token(), &fmu.resources());
    let instance = done("instantiation", created)?;
    done("setting terminate_at_end", instance.set_boolean(TERMINATE_REFERENCE, true))?;
    done("initialisation", instance.initialize())?;
    Ok(instance)
}

fn outcome(truth: &Unpacked, row: &[f64]) -> &'static str {
    let code = truth.model.output_offset("outcome").map(|index| row[1 + index]);
    let found = Outcome::ALL.into_iter().find(|outcome| Some(f64::from(*outcome as u8)) == code);
    found.map_or("no outcome", Outcome::name)
}

/// Outputs of one model, and the inputs of another that have their names.
struct Wire {
    from: Vec<u32>,
    to: Vec<u32>,
    /// Scalars in all of them.
    count: usize,
}

impl Wire {
    fn between(source: &Unpacked, sink: &Unpacked) -> Self {
        let inputs = listed(sink, |slot| matches!(slot, Slot::Input(_)));
        let mut wire = Self { from: Vec::new(), to: Vec::new(), count: 0 };
        for output in listed(source, |slot| matches!(slot, Slot::Output(_))) {
            if let Some(input) = inputs.iter().find(|input| input.name == output.name) {
                wire.from.push(output.reference);
                wire.to.push(input.reference);
                wire.count += output.size;
            }
        }
        wire
    }

    /// All outputs, to nowhere.
    fn outputs(source: &Unpacked) -> Self {
        let outputs = listed(source, |slot| matches!(slot, Slot::Output(_)));
        let from = outputs.iter().map(|output| output.reference).collect();
        Self { from, to: Vec::new(), count: source.model.output_len() }
    }

    fn read(&self, source: &Instance) -> Result<Vec<f64>, String> {
        done("reading outputs", source.get(&self.from, self.count))
    }

    fn carry(&self, source: &Instance, sink: &Instance) -> Result<(), String> {
        done("setting inputs", sink.set(&self.to, &self.read(source)?))
    }
}

fn listed(fmu: &Unpacked, wanted: fn(Slot) -> bool) -> Vec<Variable> {
    let all = variables(fmu.model, fmu.variant).into_iter();
    all.filter(|variable| wanted(variable.slot)).collect()
}
