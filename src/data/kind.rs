//! Which kind of file a recording is in, told by its first bytes.

/// A kind of file, and how messages speak of its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Text with a header line.
    Csv,
    /// MATLAB, versions 5 to 7.2.
    Mat5,
    /// MATLAB 7.3, or any HDF5.
    Hdf5,
    /// Apache Parquet.
    Parquet,
}

/// First bytes of HDF5; MATLAB puts 512 bytes of its own before them.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

impl FileKind {
    /// The kind of a file of these bytes. What is nothing else is taken as text.
    pub(super) fn of(bytes: &[u8]) -> FileKind {
        let mat5 = bytes.starts_with(b"MATLAB 5.0")
            || matches!(bytes.get(124..128), Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']));
        let hdf5 = [0, 512, 1024, 2048].iter().any(|at| bytes.get(*at..).is_some_and(|rest| rest.starts_with(HDF5)));
        match (bytes.starts_with(b"PAR1"), hdf5 || bytes.starts_with(b"MATLAB 7.3"), mat5) {
            (true, ..) => FileKind::Parquet,
            (_, true, _) => FileKind::Hdf5,
            (_, _, true) => FileKind::Mat5,
            _ => FileKind::Csv,
        }
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            FileKind::Csv => "CSV",
            FileKind::Mat5 => "MAT (version 5)",
            FileKind::Hdf5 => "MAT 7.3 (HDF5)",
            FileKind::Parquet => "Parquet",
        }
    }

    /// Where its columns are named, for a message.
    pub(super) fn heading(self) -> &'static str {
        if self == FileKind::Csv { "line 1: " } else { "" }
    }

    /// What holds one quantity.
    pub(super) fn column(self) -> &'static str {
        if self.is_mat() { "variable" } else { "column" }
    }

    /// What holds one instant.
    pub(super) fn row(self) -> &'static str {
        match self {
            FileKind::Csv => "line",
            FileKind::Parquet => "row",
            FileKind::Mat5 | FileKind::Hdf5 => "sample",
        }
    }

    /// Whether MATLAB writes it.
    pub(super) fn is_mat(self) -> bool {
        matches!(self, FileKind::Mat5 | FileKind::Hdf5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_tell_the_kind() {
        let at = |offset: usize, text: &[u8]| [vec![b' '; offset], text.to_vec()].concat();
        assert_eq!(FileKind::of(b"t,q,qd,F\n"), FileKind::Csv);
        assert_eq!(FileKind::of(b""), FileKind::Csv);
        assert_eq!(FileKind::of(b"PAR1\x15"), FileKind::Parquet);
        assert_eq!(FileKind::of(&at(512, HDF5)), FileKind::Hdf5);
        assert_eq!(FileKind::of(HDF5), FileKind::Hdf5);
        assert_eq!(FileKind::of(&at(100, HDF5)), FileKind::Csv);
        assert_eq!(FileKind::of(&at(124, b"\x00\x01IM")), FileKind::Mat5);
        assert_eq!(FileKind::of(&at(124, b"\x01\x00MI")), FileKind::Mat5);
        assert_eq!(FileKind::of(b"MATLAB 5.0 MAT-f"), FileKind::Mat5);
    }
}
