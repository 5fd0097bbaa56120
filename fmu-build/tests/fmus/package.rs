//! Packs real tables and resources around stand-in libraries.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::workshop::{FMI3, Workshop, problems, read_bytes, read_entry, tamper};
use fmi_adapter::{Variant, variables};
use fmu_build::check::{Demands, inspect};
use fmu_build::model::{MODELS, library_files};
use fmu_build::{Stamp, vehicle};

#[test]
fn two_builds_give_equal_bytes_and_the_date_is_the_only_difference() {
    let workshop = Workshop::new("equal");
    let first = workshop.build("first", Stamp::default()).unwrap();
    let second = workshop.build("second", Stamp::default()).unwrap();
    let later = workshop.build("later", Stamp::parse(Some("1700000000")).unwrap()).unwrap();
    for ((first, second), later) in first.iter().zip(&second).zip(&later) {
        assert_eq!(fs::read(first).unwrap(), fs::read(second).unwrap());
        assert_ne!(fs::read(first).unwrap(), fs::read(later).unwrap());
        assert_eq!(problems(first), Vec::<String>::new());
        assert_eq!(problems(later), Vec::<String>::new());
    }
    let left: Vec<_> = fs::read_dir(workshop.0.join("first")).unwrap().collect();
    assert_eq!(left.len(), 6, "{left:?}");
}

#[test]
fn the_xml_lists_exactly_the_variables_of_the_table() {
    let workshop = Workshop::new("xml");
    let all = MODELS.into_iter().flat_map(|model| Variant::ALL.map(|variant| (model, variant)));
    for (file, (model, variant)) in workshop.build("out", Stamp::default()).unwrap().iter().zip(all)
    {
        let text = read_entry(file, "modelDescription.xml");
        let document = roxmltree::Document::parse(&text).unwrap();
        let listed: Vec<_> = document
            .descendants()
            .filter(|node| node.parent().is_some_and(|p| p.has_tag_name("ModelVariables")))
            .filter(roxmltree::Node::is_element)
            .map(|node| node.attribute("name").unwrap().to_owned())
            .collect();
        let expected: Vec<_> = variables(model, variant).into_iter().map(|v| v.name).collect();
        assert_eq!(listed, expected);
        let signals = match variant {
            Variant::Fmi2 | Variant::Fmi3 => model.input_len() + model.output_len(),
            Variant::Fmi3Arrays => model.inputs.len() + model.outputs.len(),
        };
        assert_eq!(listed.len(), 4 + signals);
    }
}

#[test]
fn resources_are_the_files_of_the_models_folder() {
    let workshop = Workshop::new("resources");
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let file = &workshop.build("out", Stamp::default()).unwrap()[0];
    for (folder, kind) in [("scenarios", "toml"), ("vehicles", "toml"), ("terrain", "tif")] {
        let sources = fs::read_dir(models.join(folder)).unwrap().map(|e| e.unwrap().path());
        for source in sources.filter(|source| source.extension().unwrap() == kind) {
            let name = source.file_name().unwrap().to_str().unwrap();
            let packed = read_bytes(file, &format!("resources/{folder}/{name}"));
            assert_eq!(packed, fs::read(&source).unwrap());
        }
    }
}

#[test]
fn a_missing_library_is_named_and_leaves_nothing() {
    let workshop = Workshop::new("missing");
    // The second model's: the first archive must not appear either.
    let missing = workshop.0.join("libraries").join(&library_files(MODELS[1])[0]);
    fs::remove_file(&missing).unwrap();
    let message = workshop.build("out", Stamp::default()).unwrap_err().to_string();
    assert!(message.contains(missing.to_str().unwrap()), "{message}");
    assert!(!workshop.0.join("out").exists());
}

#[test]
fn check_finds_what_was_tampered_with() {
    let workshop = Workshop::new("tampered");
    for (from, to, expected) in [
        ("name=\"mass_kg\"", "name=\"mass\"", "variable mass_kg is missing"),
        ("declaredType=\"Mass\" min", "declaredType=\"Force\" min", "variable mass_kg is"),
        ("causality=\"input\"", "causality=\"local\"", "variable thrust_command_n is"),
        ("instantiationToken=\"", "instantiationToken=\"0", "instantiationToken is"),
        ("<Output valueReference=\"2000\" dependencies=\"\"/>", "", "ModelStructure/Output"),
        ("modelIdentifier=\"lander", "modelIdentifier=\"Lander", "modelIdentifier is"),
        ("modelName=\"lander", "modelName=\"other", "modelName \"other-truth\""),
        ("</ModelVariables>", "", "modelDescription.xml: "),
    ] {
        let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
        tamper(file, from, to);
        let problems = problems(file);
        assert!(problems.iter().any(|p| p.starts_with(expected)), "{from}: {problems:?}");
    }
    let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
    fs::write(file, "no archive").unwrap();
    assert!(inspect(file, &Demands::default()).is_err());
}

#[test]
fn what_is_no_library_is_not_packed() {
    let workshop = Workshop::new("no-library");
    let library = workshop.0.join("libraries").join(&library_files(MODELS[0])[0]);
    fs::write(&library, "no library").unwrap();
    let message = workshop.build("out", Stamp::default()).unwrap_err().to_string();
    assert!(message.contains(library.to_str().unwrap()), "{message}");
    assert!(message.contains("is no shared library"), "{message}");
}

#[test]
fn two_libraries_for_one_platform_are_an_error() {
    let workshop = Workshop::new("same-platform");
    let folder = workshop.0.join("libraries");
    let message = workshop.build_from(&[folder.clone(), folder], "out").unwrap_err().to_string();
    assert!(message.ends_with("another folder has a library for x86_64-linux too"), "{message}");
}

#[test]
fn a_new_vehicle_flies_at_once_and_overwrites_nothing() {
    let workshop = Workshop::new("vehicle");
    let kit = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    for file in ["vehicles/bug.toml", "scenarios/landing.toml"] {
        let copy = workshop.0.join("models").join(file);
        fs::create_dir_all(copy.parent().unwrap()).unwrap();
        fs::copy(kit.join(file), copy).unwrap();
    }
    let made = vehicle::create(&workshop.0, "moth", "bug").unwrap();
    let (scenario, vehicle) = lander_models::Scenario::load(&made[1]).unwrap();
    assert_eq!((&*scenario.name, &*vehicle.name), ("moth", "moth"));
    for (name, from, part) in [
        ("moth", "bug", "vehicles/moth.toml: exists already"),
        ("a/b", "bug", "vehicle name \"a/b\""),
        ("fly", "nobody", "vehicles/nobody.toml: cannot be read"),
    ] {
        let message = vehicle::create(&workshop.0, name, from).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    assert!(!workshop.0.join("models/vehicles/fly.toml").exists());
}

/// Runs `fmu-build describe` with its standard output at `target`.
fn describe_into(target: impl Into<Stdio>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-build"));
    command.arg("describe").stdout(target).stderr(Stdio::piped());
    command.spawn().unwrap().wait_with_output().unwrap()
}

#[test]
fn describe_ends_quietly_when_nobody_reads_on() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = describe_into(writer);
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}

#[test]
fn describe_fails_when_it_cannot_write() {
    let output = describe_into(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.starts_with("error: standard output: cannot be written: "), "{message}");
}
