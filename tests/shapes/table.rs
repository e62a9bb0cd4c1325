//! A motion written as text, in many ways.

/// Samples of the motion.
pub const COUNT: usize = 300;

/// t, q, q̇, F of a sample, SI.
pub fn truth(index: usize) -> [f64; 4] {
    let t = index as f64 * 0.01;
    [t, 0.02 * (2.0 * t).sin(), 0.04 * (2.0 * t).cos(), 5.0 * (1.3 * t + 0.4).sin()]
}

/// How columns are named.
#[derive(Clone, Copy, PartialEq)]
pub enum Names {
    Default,
    English,
    German,
    Channels,
    None,
}

/// Where units stand.
#[derive(Clone, Copy, PartialEq)]
pub enum Units {
    None,
    Brackets,
    Endings,
    Row,
    BracketRow,
    Odd,
}

/// What times are like.
#[derive(Clone, Copy, PartialEq)]
pub enum Clock {
    Seconds,
    Milliseconds,
    Iso,
    Blank,
    German,
    Midnight,
    Coarse,
    None,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Encoding {
    Utf8,
    Mark,
    Latin,
    Utf16Little,
    Utf16Big,
}

/// How a file is written.
#[derive(Clone, Copy)]
pub struct Table {
    pub separator: &'static str,
    pub comma: bool,
    pub quoted: bool,
    pub preamble: &'static str,
    pub mark: &'static str,
    pub names: Names,
    pub units: Units,
    pub clock: Clock,
    pub encoding: Encoding,
    pub end: &'static str,
    pub trailing: bool,
    pub fortran: bool,
    pub micrometres: bool,
    /// What stands in lines 7 to 10 in place of q.
    pub holes: &'static str,
}

impl Default for Table {
    fn default() -> Table {
        Table {
            separator: ",",
            comma: false,
            quoted: false,
            preamble: "",
            mark: "",
            names: Names::Default,
            units: Units::None,
            clock: Clock::Seconds,
            encoding: Encoding::Utf8,
            end: "\n",
            trailing: false,
            fortran: false,
            micrometres: false,
            holes: "",
        }
    }
}

impl Table {
    /// The file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut text = self.preamble.to_string();
        if self.names != Names::None {
            text += &format!("{}{}\n", self.mark, self.line(self.header()));
        }
        if let Some(units) = self.unit_row() {
            text += &(self.line(units) + "\n");
        }
        for index in 0..COUNT {
            text += &(self.line(self.row(index)) + "\n");
        }
        self.encoded(&text.replace('\n', self.end))
    }

    fn line(&self, cells: Vec<String>) -> String {
        let cells: Vec<String> =
            cells.into_iter().map(|cell| if self.quoted { format!("\"{cell}\"") } else { cell }).collect();
        cells.join(self.separator) + if self.trailing { self.separator } else { "" }
    }

    /// Unit and how many of them are one of SI.
    fn unit(&self, column: usize) -> (&'static str, f64) {
        let small = if self.micrometres { ("µm", 1e6) } else { ("mm", 1e3) };
        match (self.units, column) {
            (Units::None, _) => ("", if column == 0 && self.clock == Clock::Milliseconds { 1e3 } else { 1.0 }),
            (_, 0) if self.clock == Clock::Milliseconds => ("ms", 1e3),
            (_, 0) => ("s", 1.0),
            (Units::Odd, 1) => ("furlong", 1.0),
            (_, 1) => small,
            (_, 2) => ("mm/s", 1e3),
            _ => ("kN", 1e-3),
        }
    }

    fn columns(&self) -> std::ops::Range<usize> {
        if self.clock == Clock::None { 1..4 } else { 0..4 }
    }

    fn header(&self) -> Vec<String> {
        let names = match self.names {
            Names::English => ["Time", "Position", "Velocity", "Force"],
            Names::German => ["Zeit", "Weg", "Geschwindigkeit", "Kraft"],
            Names::Channels => ["CH0", "CH1", "CH2", "CH3"],
            Names::Default | Names::None => ["t", "q", "qd", "F"],
        };
        let header = |column: usize| match self.units {
            _ if column == 0 && !matches!(self.clock, Clock::Seconds | Clock::Milliseconds) => names[0].to_string(),
            Units::Brackets | Units::Odd => format!("{} [{}]", names[column], self.unit(column).0),
            Units::Endings => format!("{}_{}", names[column], self.unit(column).0),
            _ => names[column].to_string(),
        };
        self.columns().map(header).collect()
    }

    fn unit_row(&self) -> Option<Vec<String>> {
        let unit = |column: usize| match self.units {
            Units::BracketRow => format!("[{}]", self.unit(column).0),
            _ => self.unit(column).0.to_string(),
        };
        matches!(self.units, Units::Row | Units::BracketRow).then(|| self.columns().map(unit).collect())
    }

    fn row(&self, index: usize) -> Vec<String> {
        let values = truth(index);
        let cell = |column: usize| match column {
            0 => self.time(values[0]),
            1 if (5..=8).contains(&index) && !self.holes.is_empty() => self.holes.to_string(),
            _ => self.number(values[column] * self.unit(column).1),
        };
        self.columns().map(cell).collect()
    }

    fn time(&self, t: f64) -> String {
        let clock = |start: f64| {
            let all = (start + t) % 86_400.0;
            let (hours, minutes) = ((all / 3600.0).floor(), (all % 3600.0 / 60.0).floor());
            format!("{hours:02}:{minutes:02}:{:06.3}", all % 60.0)
        };
        match self.clock {
            Clock::Iso => format!("2024-05-01T{}Z", clock(43_199.0)),
            Clock::Blank => format!("2024-05-01 {}", clock(43_199.0)),
            Clock::German => {
                format!("01.05.2024 {}", clock(43_199.0)).replacen(".", "#", 2).replace('.', ",").replace('#', ".")
            }
            Clock::Midnight => clock(86_398.5),
            Clock::Coarse => clock(43_199.0)[..8].to_string(),
            _ => self.number(t * self.unit(0).1),
        }
    }

    fn number(&self, value: f64) -> String {
        let text = if self.fortran { format!("{value:.9e}").replace('e', "D") } else { format!("{value:.9}") };
        if self.comma { text.replace('.', ",") } else { text }
    }

    fn encoded(&self, text: &str) -> Vec<u8> {
        let units = |mark: [u8; 2], order: fn(u16) -> [u8; 2]| {
            mark.into_iter().chain(text.encode_utf16().flat_map(order)).collect()
        };
        match self.encoding {
            Encoding::Utf8 => text.as_bytes().to_vec(),
            Encoding::Mark => format!("\u{feff}{text}").into_bytes(),
            Encoding::Latin => text.chars().map(|c| c as u8).collect(),
            Encoding::Utf16Little => units([0xff, 0xfe], u16::to_le_bytes),
            Encoding::Utf16Big => units([0xfe, 0xff], u16::to_be_bytes),
        }
    }
}
