//! The platforms that an FMU can hold libraries for, and what a library asks of its platform.

use std::collections::BTreeSet;

use fmi_adapter::Variant;
use object::read::elf::ElfFile64;
use object::read::{File, ImportFlags, NameOrOrdinal, Object};
use object::{Architecture, BinaryFormat, elf};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Platform {
    LinuxX86_64,
    LinuxAarch64,
    WindowsX86_64,
}

impl Platform {
    pub const ALL: [Self; 3] = [Self::LinuxX86_64, Self::LinuxAarch64, Self::WindowsX86_64];

    /// The tuple of FMI 3.0.
    pub fn name(self) -> &'static str {
        match self {
            Self::LinuxX86_64 => "x86_64-linux",
            Self::LinuxAarch64 => "aarch64-linux",
            Self::WindowsX86_64 => "x86_64-windows",
        }
    }

    /// Folder below `binaries`. FMI 2.0 has names of its own for the platforms that it knows.
    pub fn folder(self, variant: Variant) -> &'static str {
        match (variant, self) {
            (Variant::Fmi2, Self::LinuxX86_64) => "linux64",
            (Variant::Fmi2, Self::WindowsX86_64) => "win64",
            _ => self.name(),
        }
    }

    /// Of a shared library's file name.
    pub fn extension(self) -> &'static str {
        if self == Self::WindowsX86_64 { "dll" } else { "so" }
    }

    /// That of this program, if it is one of these.
    pub fn here() -> Option<Self> {
        let name = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
        Self::ALL.into_iter().find(|platform| platform.name() == name)
    }
}

/// A version of glibc, as 2.17.
pub type Glibc = (u32, u32);

/// What a shared library says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Library {
    pub platform: Platform,
    /// Names of its functions.
    pub exports: BTreeSet<String>,
    /// File names of the libraries that it is loaded with.
    pub needs: BTreeSet<String>,
    /// The least glibc that has every symbol asked for; none on Windows.
    pub glibc: Option<Glibc>,
}

impl Library {
    /// Reads the headers of an ELF or PE file; the reason if it is no library for a known platform.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        Self::parse(bytes).map_err(|error| format!("is no shared library: {error}"))?
    }

    fn parse(bytes: &[u8]) -> object::Result<Result<Self, String>> {
        let file = File::parse(bytes)?;
        let platform = match (file.format(), file.architecture()) {
            (BinaryFormat::Elf, Architecture::X86_64) => Platform::LinuxX86_64,
            (BinaryFormat::Elf, Architecture::Aarch64) => Platform::LinuxAarch64,
            (BinaryFormat::Pe, Architecture::X86_64) => Platform::WindowsX86_64,
            (format, machine) => return Ok(Err(format!("is {format:?} for {machine:?}"))),
        };
        let mut exports = BTreeSet::new();
        for export in file.exports()? {
            if let NameOrOrdinal::Name(name) = export?.name() {
                exports.insert(text(name));
            }
        }
        let (mut needs, mut glibc) = (BTreeSet::new(), None);
        for import in file.imports()? {
            let import = import?;
            match import.flags() {
                ImportFlags::Elf { version, .. } => glibc = glibc.max(version.and_then(version_of)),
                _ => drop(needs.insert(text(import.library()))),
            }
        }
        // The symbols of ELF do not say where they come from.
        if let File::Elf64(file) = &file {
            needs = needed(file)?;
        }
        Ok(Ok(Self { platform, exports, needs, glibc }))
    }

    /// Those that a plain system does not have.
    pub fn foreign_needs(&self) -> Vec<&str> {
        let needs = self.needs.iter().map(String::as_str);
        needs.filter(|name| !belongs_to_system(self.platform, name)).collect()
    }
}

fn needed(file: &ElfFile64) -> object::Result<BTreeSet<String>> {
    let table = file.elf_section_table().dynamic_table(file.endian(), file.data())?;
    let needed = table.iter().filter(|entry| entry.tag == elf::DT_NEEDED);
    needed.map(|entry| Ok(text(table.string(entry)?))).collect()
}

/// The C library's family on Linux, what every Windows 10 has.
fn belongs_to_system(platform: Platform, name: &str) -> bool {
    match platform {
        Platform::LinuxX86_64 | Platform::LinuxAarch64 => {
            let stem = name.split(".so").next().unwrap_or_default();
            let family = ["libc", "libm", "libdl", "librt", "libpthread", "libgcc_s"];
            family.contains(&stem) || stem.starts_with("ld-linux")
        }
        Platform::WindowsX86_64 => {
            let name = name.to_ascii_lowercase();
            let stem = name.strip_suffix(".dll").unwrap_or(&name);
            let family = ["kernel32", "ntdll", "advapi32", "userenv", "ws2_32", "bcrypt"];
            let runtime = ["msvcrt", "ucrtbase", "bcryptprimitives"];
            family.contains(&stem) || runtime.contains(&stem) || stem.starts_with("api-ms-win-")
        }
    }
}

/// (2, 17) from `GLIBC_2.17`; the third number of old versions does not matter.
fn version_of(symbol_version: &[u8]) -> Option<Glibc> {
    let numbers = std::str::from_utf8(symbol_version).ok()?.strip_prefix("GLIBC_")?;
    parse_glibc(numbers)
}

/// (2, 17) from `2.17`.
pub fn parse_glibc(text: &str) -> Option<Glibc> {
    let mut numbers = text.split('.').map(|number| number.parse().ok());
    Some((numbers.next()??, numbers.next()??))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
