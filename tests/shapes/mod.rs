//! Recordings as engineers bring them: the same motion written in more than forty shapes, each read right or refused in
//! one sentence that says what mends it.

mod table;

use switchid::data::open_recording;
use switchid::law::{Columns, Given, Model, Term};
use table::{COUNT, Clock, Encoding, Names, Table, Units, truth};

/// What is to come of a shape.
enum Outcome {
    /// Read: t, q, q̇ and F, where they are in the file, with rounding to so many decimals of the file's unit.
    Read,
    /// Refused in one sentence that holds these words.
    Refused(&'static [&'static str]),
}

struct Shape {
    name: &'static str,
    bytes: Vec<u8>,
    columns: Columns,
    outcome: Outcome,
}

fn read(name: &'static str, table: Table) -> Shape {
    Shape { name, bytes: table.bytes(), columns: Columns::default(), outcome: Outcome::Read }
}

fn named(name: &'static str, table: Table, columns: [&str; 4]) -> Shape {
    let [t, q, qd, excitation] = columns.map(|column| (!column.is_empty()).then(|| column.to_string()));
    Shape { columns: Columns { t, q, qd, excitation, ..Columns::default() }, ..read(name, table) }
}

fn refused(name: &'static str, bytes: Vec<u8>, words: &'static [&'static str]) -> Shape {
    Shape { name, bytes, columns: Columns::default(), outcome: Outcome::Refused(words) }
}

/// Plain files, and one thing after the other that differs.
fn shapes() -> Vec<Shape> {
    let plain = Table::default;
    let german = || Table { separator: ";", comma: true, names: Names::German, units: Units::Brackets, ..plain() };
    let free = |table: Table| Table { names: Names::None, ..table };
    let preamble = "Rig 3; run 5\nOperator: M. Muster, Lab 2\nChannels: 4\n\n";
    let mut shapes = vec![
        read("plain", plain()),
        read("semicolons", Table { separator: ";", ..plain() }),
        read("tabs", Table { separator: "\t", ..plain() }),
        read("pipes", Table { separator: " | ", ..plain() }),
        read("blanks", Table { separator: "  ", ..plain() }),
        read("decimal commas", Table { separator: ";", comma: true, ..plain() }),
        read("decimal commas and tabs", Table { separator: "\t", comma: true, ..plain() }),
        read("decimal commas and blanks", Table { separator: " ", comma: true, ..plain() }),
        read("decimal commas in quotes", Table { comma: true, quoted: true, ..plain() }),
        read("a German spreadsheet's export", german()),
        read("the same in ISO 8859-1", Table { encoding: Encoding::Latin, micrometres: true, ..german() }),
        read("the same in UTF-16", Table { encoding: Encoding::Utf16Little, ..german() }),
        read("UTF-16 of the other order", Table { encoding: Encoding::Utf16Big, ..german() }),
        read("a byte order mark", Table { encoding: Encoding::Mark, ..plain() }),
        read("carriage returns and line feeds", Table { end: "\r\n", ..plain() }),
        read("carriage returns alone", Table { end: "\r", ..plain() }),
        read("a preamble", Table { preamble, ..plain() }),
        read("a preamble above semicolons", Table { preamble, ..german() }),
        read("a line of units", Table { units: Units::Row, ..plain() }),
        read("a line of units in brackets", Table { units: Units::BracketRow, separator: "\t", ..plain() }),
        read("preamble, header, units", Table { preamble, units: Units::Row, ..german() }),
        read("units behind underscores", Table { units: Units::Endings, ..plain() }),
        read("English names", Table { names: Names::English, units: Units::Brackets, ..plain() }),
        read("units tell the columns", Table { names: Names::Channels, units: Units::Brackets, ..plain() }),
        read("a header behind a #", Table { mark: "# ", separator: " ", ..plain() }),
        read("remarks behind a %", Table { preamble: "% saved by the rig\n% at noon\n", mark: "% ", ..plain() }),
        read("separators at the ends of lines", Table { trailing: true, separator: ";", ..plain() }),
        read("numbers of Fortran", Table { fortran: true, separator: " ", ..plain() }),
        read("milliseconds", Table { clock: Clock::Milliseconds, units: Units::Brackets, ..plain() }),
        read("ISO 8601", Table { clock: Clock::Iso, names: Names::English, ..plain() }),
        read(
            "date and time with a blank",
            Table { clock: Clock::Blank, separator: ";", names: Names::English, ..plain() },
        ),
        read("German dates", Table { clock: Clock::German, ..german() }),
        read(
            "clock times over midnight",
            Table { clock: Clock::Midnight, names: Names::German, separator: "\t", ..plain() },
        ),
        read("a rate in the preamble", Table { clock: Clock::None, preamble: "Sample rate: 100 Hz\n", ..plain() }),
        read("a step in the preamble", Table { clock: Clock::None, preamble: "# dt = 10 ms\n", ..plain() }),
        read("no header, told by the numbers", free(plain())),
        read("no header, decimal commas", free(Table { separator: ";", comma: true, ..plain() })),
        named("no header, named by position", free(plain()), ["1", "2", "3", "4"]),
        named("a rate in place of times", Table { clock: Clock::None, ..plain() }, ["100 Hz", "q", "", "F"]),
        named("odd names", Table { names: Names::Channels, ..plain() }, ["CH0", "CH1", "CH2", "CH3"]),
        named(
            "names with blanks",
            Table { names: Names::German, units: Units::Brackets, ..german() },
            ["Zeit", "Weg", "", "Kraft"],
        ),
    ];
    let told = |table: Table| table.bytes();
    shapes.extend([
        refused(
            "odd names that nobody told",
            told(Table { names: Names::Channels, ..plain() }),
            &["\"CH1\"", "--columns"],
        ),
        refused("commas for everything", told(Table { comma: true, ..plain() }), &["decimal", "semicolons"]),
        refused(
            "clock times without decimals",
            told(Table { clock: Clock::Coarse, names: Names::English, ..plain() }),
            &["repeats", "--columns t="],
        ),
        refused("no times at all", told(Table { clock: Clock::None, ..plain() }), &["\"t\"", "--columns t=1000Hz"]),
        refused(
            "two cells that are none",
            told(Table { holes: "n/a", ..plain() }),
            &["line 7", "\"q\"", "n/a", "3 more lines", "line 10"],
        ),
        refused("an unknown unit", told(Table { units: Units::Odd, ..plain() }), &["furlong", "mm"]),
        refused("MDF 3", b"MDF     3.30    asammdf\0\0\0".to_vec(), &["MDF", "asammdf"]),
        refused("TDMS", b"TDSm\x0e\0\0\0".to_vec(), &["TDMS", "csv"]),
        refused("a letter", b"Dear Sir,\nplease find the data attached.\n".to_vec(), &["read as a table", "header"]),
        refused("nothing", b"\n\n".to_vec(), &["empty"]),
    ]);
    shapes
}

fn model(columns: Columns) -> Model {
    let terms = [Term::Inertia, Term::power(0, 1), Term::power(1, 0)].map(|term| (term, Given::Fit));
    Model { columns, ..Model::of("any", terms) }
}

/// Why a shape did not come out as it must.
fn fault(shape: &Shape, folder: &std::path::Path) -> Option<String> {
    let path = folder.join("run@1:2.dat");
    std::fs::write(&path, &shape.bytes).unwrap();
    let opened = open_recording(path.to_str().unwrap(), &model(shape.columns.clone()));
    match (&shape.outcome, opened) {
        (Outcome::Read, Ok(opened)) => {
            let recording = &opened.recording;
            if recording.count() != COUNT {
                return Some(format!("{} samples", recording.count()));
            }
            let channels = recording.channels();
            (0..COUNT).find_map(|index| {
                let (found, [t, q, qd, force]) = (recording.sample(index), truth(index));
                let far = |found: f64, truth: f64| (found - truth).abs() > 2e-6;
                let off = far(found.t - recording.sample(0).t, t)
                    || channels.q && far(found.q, q)
                    || channels.qd && far(found.qd, qd)
                    || far(found.excitation, force);
                off.then(|| format!("sample {index} is {found:?}, not {:?}", [t, q, qd, force]))
            })
        }
        (Outcome::Read, Err(error)) => Some(error.to_string()),
        (Outcome::Refused(words), Err(error)) => {
            let told = error.to_string();
            let silent = words.iter().find(|word| !told.contains(**word));
            let long = (told.lines().count() > 1).then(|| format!("several lines: {told}"));
            silent.map(|word| format!("no `{word}` in: {told}")).or(long)
        }
        (Outcome::Refused(_), Ok(opened)) => Some(format!("was read: {:?}", opened.columns)),
    }
}

#[test]
fn every_shape_is_read_or_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let shapes = shapes();
    assert!(shapes.len() >= 40);
    let faults: Vec<String> =
        shapes.iter().filter_map(|shape| Some(format!("{}: {}", shape.name, fault(shape, folder.path())?))).collect();
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), shapes.len(), faults.join("\n"));
}

#[test]
fn what_is_guessed_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let table = Table { separator: ";", comma: true, names: Names::German, units: Units::Row, ..Table::default() };
    std::fs::write(&path, table.bytes()).unwrap();
    let opened = open_recording(path.to_str().unwrap(), &model(Columns::default())).unwrap();
    let said = opened.guessed.unwrap();
    for word in ["between \";\"", "decimal commas", "units in line 2", "q = \"Weg [mm]\" (by its name)", "--columns"] {
        assert!(said.contains(word), "no `{word}` in: {said}");
    }
    assert_eq!(said.lines().count(), 1);
    std::fs::write(&path, Table::default().bytes()).unwrap();
    assert_eq!(open_recording(path.to_str().unwrap(), &model(Columns::default())).unwrap().guessed, None);
}
