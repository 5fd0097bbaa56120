//! docs/FMI.md: which capabilities the FMUs declare, read from modelDescription.xml as written.

use fmi_adapter::Variant;
use lander_models::Ticks;
use lander_models::signals::TRUTH;
use roxmltree::Document;

use crate::description::model_description;
use crate::{Error, Stamp};

/// Every flag of a CoSimulation element, by its names in FMI 2.0 and 3.0, what it means, and the
/// test that exercises it where it is declared.
const FLAGS: [(&str, &str, &str, &str); 19] = [
    (
        "canGetAndSetFMUstate",
        "canGetAndSetFMUState",
        "a state can be taken and put back",
        "cosim-tests/python/tests/test_states.py",
    ),
    (
        "canSerializeFMUstate",
        "canSerializeFMUState",
        "as bytes too, for another instance or process",
        "cosim-tests/python/tests/test_states.py",
    ),
    (
        "canHandleVariableCommunicationStepSize",
        "canHandleVariableCommunicationStepSize",
        "any whole number of milliseconds, another one each time",
        "cosim-tests/python/tests/test_events.py",
    ),
    ("", "fixedInternalStepSize", "the tick, s", "cosim-tests/python/tests/test_events.py"),
    (
        "",
        "hasEventMode",
        "touchdown, light-up and cut-off, verdict, onset of a fault",
        "cosim-tests/python/tests/test_events.py",
    ),
    (
        "",
        "mightReturnEarlyFromDoStep",
        "truth, at an event; guidance's events are at the ends of steps",
        "cosim-tests/python/tests/test_events.py",
    ),
    (
        "canNotUseMemoryManagementFunctions",
        "",
        "memory is the FMU's own",
        "fmu-build/adapter/tests/boundary/fmi2.rs",
    ),
    (
        "canBeInstantiatedOnlyOncePerProcess",
        "canBeInstantiatedOnlyOncePerProcess",
        "no limit to instances, in any thread",
        "",
    ),
    ("needsExecutionTool", "needsExecutionTool", "nothing to install", ""),
    ("canInterpolateInputs", "", "inputs are held over a step", ""),
    ("maxOutputDerivativeOrder", "maxOutputDerivativeOrder", "", ""),
    ("canRunAsynchronuously", "", "a step is done when it returns", ""),
    ("providesDirectionalDerivative", "providesDirectionalDerivatives", "", ""),
    ("", "providesAdjointDerivatives", "", ""),
    ("", "providesPerElementDependencies", "", ""),
    ("", "recommendedIntermediateInputSmoothness", "", ""),
    ("", "providesIntermediateUpdate", "", ""),
    ("", "canReturnEarlyAfterIntermediateUpdate", "", ""),
    ("", "providesEvaluateDiscreteStates", "", ""),
];

const HEAD: &str = "\
# FMI capabilities

Generated from the flags in `modelDescription.xml`: `fmu-build describe --capabilities > docs/FMI.md`.
What is not declared exists as a function that logs \"not supported\" and returns an error.

| flag | FMI 2.0 | FMI 3.0 | | exercised by |
|---|---|---|---|---|
";

/// The document.
pub fn page() -> Result<String, Error> {
    let (two, three) = (declared(Variant::Fmi2)?, declared(Variant::Fmi3)?);
    let mut text = HEAD.to_owned();
    for (in_two, in_three, meaning, test) in FLAGS {
        let value = |list: &[(String, String)], flag: &str| {
            let found = list.iter().find(|(name, _)| name == flag);
            match found {
                _ if flag.is_empty() => String::new(),
                Some((_, value)) => value.clone(),
                None => "no".to_owned(),
            }
        };
        let name = if in_three.is_empty() { in_two } else { in_three };
        let (two, three) = (value(&two, in_two), value(&three, in_three));
        text += &format!("| `{name}` | {two} | {three} | {meaning} | {test} |\n");
    }
    Ok(text)
}

/// Attributes of the CoSimulation element but its identifier.
fn declared(variant: Variant) -> Result<Vec<(String, String)>, Error> {
    let text = model_description(&TRUTH, variant, Ticks(1), Stamp::default())?;
    // What the writer wrote is well-formed; were it not, the table would be empty and the test fail.
    let Ok(document) = Document::parse(&text) else { return Ok(Vec::new()) };
    let element = document.descendants().find(|node| node.has_tag_name("CoSimulation"));
    let attributes = element.into_iter().flat_map(|node| node.attributes());
    let flags = attributes.filter(|attribute| attribute.name() != "modelIdentifier");
    Ok(flags.map(|flag| (flag.name().to_owned(), flag.value().to_owned())).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
    }

    #[test]
    fn the_document_is_up_to_date() {
        let kept = std::fs::read_to_string(root().join("docs/FMI.md")).unwrap_or_default();
        let command = "fmu-build describe --capabilities > docs/FMI.md";
        assert!(kept == page().unwrap(), "docs/FMI.md is stale: {command}");
    }

    #[test]
    fn every_declared_flag_is_listed_and_has_its_test() {
        for variant in Variant::ALL {
            let flags = declared(variant).unwrap();
            assert!(flags.len() > 2, "{flags:?}");
            for (flag, _) in flags {
                let row = FLAGS
                    .iter()
                    .find(|row| flag == if variant == Variant::Fmi2 { row.0 } else { row.1 });
                let Some((.., test)) = row else { panic!("{flag} is not in the table") };
                assert!(root().join(test).is_file(), "{flag}: no test {test:?}");
            }
        }
    }
}
