//! Which kind of file a recording is in, told by its first bytes.

/// A kind of file, and how messages speak of its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Text with its header in that line; 0 where it has none.
    Csv {
        /// The line, from 1.
        header: u64,
    },
    /// A spreadsheet: xlsx, xls, ods.
    Spreadsheet,
    /// MATLAB, versions 5 to 7.2.
    Mat5,
    /// MATLAB 7.3, or any HDF5.
    Hdf5,
    /// MDF 4 (ASAM).
    Mdf,
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
            _ if is_mdf4(bytes) => FileKind::Mdf,
            _ if is_spreadsheet(bytes) => FileKind::Spreadsheet,
            _ => FileKind::Csv { header: 1 },
        }
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            FileKind::Csv { .. } => "CSV",
            FileKind::Spreadsheet => "spreadsheet",
            FileKind::Mat5 => "MAT (version 5)",
            FileKind::Hdf5 => "MAT 7.3 (HDF5)",
            FileKind::Mdf => "MDF 4",
            FileKind::Parquet => "Parquet",
        }
    }

    /// Where its columns are named, for a message.
    pub(super) fn heading(self) -> String {
        match self {
            FileKind::Csv { header: 0 } => "there is no header, columns are named by their position: ".into(),
            FileKind::Csv { header } => format!("line {header}: "),
            _ => String::new(),
        }
    }

    /// What holds one quantity.
    pub(super) fn column(self) -> &'static str {
        match self {
            FileKind::Mat5 | FileKind::Hdf5 => "variable",
            FileKind::Mdf => "channel",
            _ => "column",
        }
    }

    /// What holds one instant.
    pub(super) fn row(self) -> &'static str {
        match self {
            FileKind::Csv { .. } => "line",
            FileKind::Parquet | FileKind::Spreadsheet => "row",
            FileKind::Mat5 | FileKind::Hdf5 | FileKind::Mdf => "sample",
        }
    }

    /// Whether MATLAB writes it.
    pub(super) fn is_mat(self) -> bool {
        matches!(self, FileKind::Mat5 | FileKind::Hdf5)
    }
}

/// Whether these are the first bytes of an archive, whose table of contents stands at its end.
pub(super) fn is_archive(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Whether these are the bytes of a compressed workbook of Office or OpenDocument, or of Excel's older format.
fn is_spreadsheet(bytes: &[u8]) -> bool {
    let has = |name: &[u8]| bytes.windows(name.len()).any(|window| window == name);
    let zipped = is_archive(bytes) && (has(b"xl/workbook") || has(b"opendocument.spreadsheet"));
    zipped || bytes.starts_with(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
}

/// Whether these are the first bytes of MDF, version 4, whether or not its logger came to finish it.
fn is_mdf4(bytes: &[u8]) -> bool {
    let mark = bytes.starts_with(b"MDF     ") || bytes.starts_with(b"UnFinMF ");
    mark && bytes.get(8) == Some(&b'4')
}

/// Files of measurements that are not read: what they are, and how they become one that is.
pub(super) fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let at = |offset: usize, mark: &[u8]| bytes.get(offset..).is_some_and(|rest| rest.starts_with(mark));
    let known: [(bool, &str, &str); 7] = [
        (
            at(0, b"MDF     ") || at(0, b"UnFinMF "),
            "an MDF file older than version 4 (ASAM)",
            "convert it: in Python, asammdf's MDF(file).convert(\"4.10\").save(\"x.mf4\")",
        ),
        (
            at(0, b"TDSm"),
            "a TDMS file (National Instruments)",
            "export it: in Python, nptdms' TdmsFile.read(file).as_dataframe(time_index=True).to_csv(\"x.csv\")",
        ),
        (
            at(0, b"\x93NUMPY"),
            "a NumPy array",
            "save it as text: numpy.savetxt(\"x.csv\", a, delimiter=\",\", header=\"t,q,qd,F\")",
        ),
        (
            at(0, b"ARROW1") || at(0, b"FEA1"),
            "an Arrow or Feather file",
            "write it as Parquet: pandas.read_feather(file).to_parquet(\"x.parquet\")",
        ),
        (at(0, b"\x1f\x8b"), "compressed (gzip)", "unpack it with gunzip"),
        (at(0, b"RIFF"), "a WAV file", "write its samples as CSV with a column of times"),
        (
            at(0, b"SQLite format 3"),
            "a database (SQLite)",
            "export the table as CSV: sqlite3 -csv -header FILE \"select * from TABLE\"",
        ),
    ];
    known.into_iter().find(|(is, ..)| *is).map(|(_, what, how)| (what, how))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_tell_the_kind() {
        let text = FileKind::Csv { header: 1 };
        let at = |offset: usize, text: &[u8]| [vec![b' '; offset], text.to_vec()].concat();
        assert_eq!(FileKind::of(b"t,q,qd,F\n"), text);
        assert_eq!(FileKind::of(b""), text);
        assert_eq!(FileKind::of(b"PAR1\x15"), FileKind::Parquet);
        assert_eq!(FileKind::of(&at(512, HDF5)), FileKind::Hdf5);
        assert_eq!(FileKind::of(HDF5), FileKind::Hdf5);
        assert_eq!(FileKind::of(&at(100, HDF5)), text);
        assert_eq!(FileKind::of(&at(124, b"\x00\x01IM")), FileKind::Mat5);
        assert_eq!(FileKind::of(&at(124, b"\x01\x00MI")), FileKind::Mat5);
        assert_eq!(FileKind::of(b"MATLAB 5.0 MAT-f"), FileKind::Mat5);
    }
}
