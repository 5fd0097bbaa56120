//! Packs real tables and resources around stand-in libraries.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use fmi_adapter::{Variant, variables};
use fmu_build::check::check;
use fmu_build::model::{MODELS, library_file};
use fmu_build::package::{Sources, build};
use fmu_build::{Error, Stamp, vehicle};

/// A folder with `libraries/`, gone when dropped.
struct Workshop(PathBuf);

/// Place of the truth model's FMI 3.0 archive in what `build` returns.
const FMI3: usize = 1;

impl Workshop {
    fn new(name: &str) -> Self {
        let folder = format!("fmu-build-test-{}-{name}", std::process::id());
        let workshop = Self(std::env::temp_dir().join(folder));
        fs::create_dir_all(workshop.0.join("libraries")).unwrap();
        for model in MODELS {
            let stand_in = b"\x7fELF stand-in that mentions fmi2DoStep and fmi3DoStep";
            fs::write(workshop.0.join("libraries").join(library_file(model)), stand_in).unwrap();
        }
        workshop
    }

    fn build(&self, out: &str, stamp: Stamp) -> Result<Vec<PathBuf>, Error> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let libraries = &self.0.join("libraries");
        build(&Sources { libraries, root, stamp }, &self.0.join(out))
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        // Left-overs in the temporary folder don't make a test wrong.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn read_entry(file: &Path, entry: &str) -> String {
    String::from_utf8(read_bytes(file, entry)).unwrap()
}

fn read_bytes(file: &Path, entry: &str) -> Vec<u8> {
    let mut zip = zip::ZipArchive::new(fs::File::open(file).unwrap()).unwrap();
    let mut bytes = Vec::new();
    zip.by_name(entry).unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

/// Replaces `from` by `to` in the model description of `file`.
fn tamper(file: &Path, from: &str, to: &str) {
    let mut source = zip::ZipArchive::new(fs::File::open(file).unwrap()).unwrap();
    let mut target = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for index in 0..source.len() {
        let entry = source.by_index_raw(index).unwrap();
        if entry.name().unwrap() != "modelDescription.xml" {
            target.raw_copy_file(entry).unwrap();
        }
    }
    let text = read_entry(file, "modelDescription.xml");
    assert!(text.contains(from), "nothing to tamper with");
    target.start_file("modelDescription.xml", zip::write::SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(&mut target, text.replacen(from, to, 1).as_bytes()).unwrap();
    fs::write(file, target.finish().unwrap().into_inner()).unwrap();
}

#[test]
fn two_builds_give_equal_bytes_and_the_date_is_the_only_difference() {
    let workshop = Workshop::new("equal");
    let first = workshop.build("first", Stamp::default()).unwrap();
    let second = workshop.build("second", Stamp::default()).unwrap();
    let later = workshop.build("later", Stamp::parse(Some("1700000000")).unwrap()).unwrap();
    for ((first, second), later) in first.iter().zip(&second).zip(&later) {
        assert_eq!(fs::read(first).unwrap(), fs::read(second).unwrap());
        assert_ne!(fs::read(first).unwrap(), fs::read(later).unwrap());
        assert_eq!(check(first).unwrap(), Vec::<String>::new());
        assert_eq!(check(later).unwrap(), Vec::<String>::new());
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
    let missing = workshop.0.join("libraries").join(library_file(MODELS[1]));
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
        ("unit=\"kg\" min", "unit=\"g\" min", "variable mass_kg is"),
        ("causality=\"input\"", "causality=\"local\"", "variable thrust_command_n is"),
        ("instantiationToken=\"", "instantiationToken=\"0", "instantiationToken is"),
        ("<Output valueReference=\"2000\" dependencies=\"\"/>", "", "ModelStructure/Output"),
        ("modelIdentifier=\"lander", "modelIdentifier=\"Lander", "modelIdentifier is"),
        ("modelName=\"lander", "modelName=\"other", "modelName \"other-truth\""),
        ("</ModelVariables>", "", "modelDescription.xml: "),
    ] {
        let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
        tamper(file, from, to);
        let problems = check(file).unwrap();
        assert!(problems.iter().any(|p| p.starts_with(expected)), "{from}: {problems:?}");
    }
    let library = workshop.0.join("libraries").join(library_file(MODELS[0]));
    fs::write(library, "no library").unwrap();
    let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
    let problems = check(file).unwrap();
    assert_eq!(problems, ["binaries/x86_64-linux/lander_truth.so is not an ELF library"]);
    fs::write(file, "no archive").unwrap();
    assert!(check(file).is_err());
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
