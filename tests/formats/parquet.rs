//! Parquet: files written by the parquet crate.

use super::{Bench, COUNT, excitation, expect, q, qd, signal, t};
use parquet::basic::{Compression, ZstdLevel};
use parquet::column::writer::ColumnWriter;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::sync::Arc;

const SCHEMA: &str = "message run { required double t; optional double q_mm; required float qd; required int32 F; \
                      optional int64 stamp (TIMESTAMP(MILLIS,true)); optional binary note (UTF8); }";

/// A file of two row groups; `holes` are the rows whose q is null.
fn file(compression: Compression, holes: &[usize]) -> Vec<u8> {
    let schema = Arc::new(parse_message_type(SCHEMA).unwrap());
    let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
    for rows in [0..25, 25..COUNT] {
        let mut group = writer.next_row_group().unwrap();
        while let Some(mut column) = group.next_column().unwrap() {
            write(column.untyped(), rows.clone(), holes);
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
    bytes
}

fn write(column: &mut ColumnWriter, rows: std::ops::Range<usize>, holes: &[usize]) {
    let none = vec![0; rows.len()];
    match column {
        ColumnWriter::DoubleColumnWriter(writer) if writer.get_descriptor().name() == "t" => {
            writer.write_batch(&signal(t)[rows], None, None)
        }
        ColumnWriter::DoubleColumnWriter(writer) => {
            let levels: Vec<i16> = rows.clone().map(|row| i16::from(!holes.contains(&row))).collect();
            let values: Vec<f64> = rows.filter(|row| !holes.contains(row)).map(q).collect();
            writer.write_batch(&values, Some(&levels), None)
        }
        ColumnWriter::FloatColumnWriter(writer) => {
            let values: Vec<f32> = rows.map(|row| qd(row) as f32).collect();
            writer.write_batch(&values, None, None)
        }
        ColumnWriter::Int32ColumnWriter(writer) => {
            let values: Vec<i32> = rows.map(|row| excitation(row) as i32).collect();
            writer.write_batch(&values, None, None)
        }
        ColumnWriter::Int64ColumnWriter(writer) => writer.write_batch(&[], Some(&none), None),
        ColumnWriter::ByteArrayColumnWriter(writer) => writer.write_batch(&[], Some(&none), None),
        _ => unreachable!("the schema has no other columns"),
    }
    .unwrap();
}

#[test]
fn columns_are_read_however_they_are_packed() {
    for compression in [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::ZSTD(ZstdLevel::default()),
        Compression::GZIP(Default::default()),
    ] {
        let opened = Bench::of(&file(compression, &[])).open("");
        assert_eq!(opened.recording.count(), COUNT);
        expect(&opened, 0, 1e-3);
        assert_eq!(opened.columns[1], "q = column \"q_mm\" in mm");
    }
}

#[test]
fn rows_without_a_value_are_named() {
    Bench::of(&file(Compression::SNAPPY, &[30, 41])).refuses("", &["row 31", "\"q_mm\" is NaN"]);
    let stream = Bench::of(&file(Compression::SNAPPY, &[30, 41])).stream();
    assert_eq!(stream.recording.incomplete().iter().map(|sample| sample.t).collect::<Vec<_>>(), [30, 41].map(t));
    assert!(stream.recording.count() == COUNT - 2 && stream.recording.incomplete()[0].q.is_nan());
    let all: Vec<usize> = (25..COUNT).collect();
    Bench::of(&file(Compression::SNAPPY, &all)).refuses("", &["row 26", "\"q_mm\""]);
}

#[test]
fn what_is_no_signal_is_named() {
    let bench = Bench::of(&file(Compression::SNAPPY, &[]));
    bench.refuses("q = \"note\"", &["column \"note\"", "text"]);
    bench.refuses("t = \"stamp\"", &["column \"stamp\"", "date or time", "seconds"]);
    bench.refuses("q = \"x\"", &["no column \"x\"", "\"q_mm\""]);
}

#[test]
fn a_file_that_breaks_off_is_refused() {
    let whole = file(Compression::SNAPPY, &[]);
    for length in [whole.len() - 1, whole.len() / 2, 12] {
        Bench::of(&whole[..length]).refuses("", &["Parquet", "damaged"]);
    }
}
