//! The platforms that FMUs are built for, as FMI names their folders.

/// A platform and what its dynamic libraries are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// The folder under `binaries`.
    pub name: &'static str,
    /// What a library's file name begins with, as cargo writes it.
    pub prefix: &'static str,
    /// Its ending.
    pub extension: &'static str,
}

/// Linux on x86-64.
pub const LINUX64: Platform = Platform { name: "linux64", prefix: "lib", extension: "so" };

/// Linux on 64-bit ARM.
pub const AARCH64_LINUX: Platform = Platform { name: "aarch64-linux", prefix: "lib", extension: "so" };

/// Windows on x86-64.
pub const WIN64: Platform = Platform { name: "win64", prefix: "", extension: "dll" };

/// macOS.
pub const DARWIN64: Platform = Platform { name: "darwin64", prefix: "lib", extension: "dylib" };

impl Platform {
    /// All of them.
    pub const ALL: [Platform; 4] = [LINUX64, AARCH64_LINUX, WIN64, DARWIN64];

    /// The file that cargo writes for the package of that name.
    pub fn file(self, package: &str) -> String {
        format!("{}{}.{}", self.prefix, package.replace('-', "_"), self.extension)
    }

    /// The one that this program runs on, where FMUs are built for it.
    pub fn of_this_machine() -> Option<Platform> {
        match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => Some(LINUX64),
            ("linux", "aarch64") => Some(AARCH64_LINUX),
            ("windows", "x86_64") => Some(WIN64),
            ("macos", _) => Some(DARWIN64),
            _ => None,
        }
    }
}
