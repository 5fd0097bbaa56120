//! A study's rows as one table: `results.csv` and `results.parquet`, a row a run in order. The only file that
//! names the Parquet writer.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::StudyError;
use super::campaign::Campaign;
use super::row::{Columns, Content};
use super::shard::VERSION;
use crate::whole_file::temporary;

/// Rows of a row group: it is what the merge holds in memory.
const GROUP_ROWS: usize = 10_000;

/// Writes both tables from the shards of all runs.
///
/// # Errors
/// A shard that is missing, a folder that cannot be written; then no table is left half-written.
pub fn merge(campaign: &Campaign) -> Result<(), StudyError> {
    let csv_file = campaign.folder.join("results.csv");
    let parquet_file = campaign.folder.join("results.parquet");
    let (csv_part, parquet_part) = (temporary(&csv_file), temporary(&parquet_file));
    let merged = write(campaign, &csv_part, &parquet_part).and_then(|()| {
        for (part, file) in [(&csv_part, &csv_file), (&parquet_part, &parquet_file)] {
            fs::rename(part, file)
                .map_err(|source| StudyError::File { file: file.clone(), source })?;
        }
        Ok(())
    });
    if merged.is_err() {
        // What failed first is the error to tell.
        let _ = fs::remove_file(&csv_part);
        let _ = fs::remove_file(&parquet_part);
    }
    merged
}

fn write(campaign: &Campaign, csv: &Path, parquet: &Path) -> Result<(), StudyError> {
    let lost = |source| StudyError::File { file: csv.to_owned(), source };
    let wrong = |error: ParquetError| refused(parquet, &error);
    let columns = campaign.columns;
    let mut text = BufWriter::new(File::create(csv).map_err(lost)?);
    let mut table = Table::create(campaign, parquet)?;
    writeln!(text, "{}", columns.header()).map_err(lost)?;
    let mut group = Vec::new();
    for shard in campaign.shards() {
        let rows = shard.read()?.ok_or_else(|| StudyError::Missing {
            folder: campaign.folder.clone(),
            first: shard.runs.start,
            last: shard.runs.end - 1,
        })?;
        for row in &rows {
            writeln!(text, "{row}").map_err(lost)?;
        }
        group.extend(rows);
        if group.len() >= GROUP_ROWS {
            table.write(columns, &group).map_err(wrong)?;
            group.clear();
        }
    }
    if !group.is_empty() {
        table.write(columns, &group).map_err(wrong)?;
    }
    text.into_inner().map_err(|error| lost(error.into_error()))?.sync_all().map_err(lost)?;
    table.writer.close().map_err(wrong)?;
    Ok(())
}

fn refused(file: &Path, error: &ParquetError) -> StudyError {
    StudyError::Parquet { file: file.to_owned(), reason: error.to_string() }
}

struct Table {
    writer: SerializedFileWriter<File>,
}

impl Table {
    fn create(campaign: &Campaign, file: &Path) -> Result<Self, StudyError> {
        let open = File::create(file)
            .map_err(|source| StudyError::File { file: file.to_owned(), source })?;
        let study = campaign.study;
        let entry = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("lander {VERSION}"))
            .set_key_value_metadata(Some(vec![
                entry("study", study.name.clone()),
                entry("study_sha256", study.hash.clone()),
                entry("version", VERSION.to_owned()),
                entry("seed", study.seed.to_string()),
            ]))
            .build();
        let writer = schema(campaign.columns)
            .and_then(|schema| SerializedFileWriter::new(open, schema, Arc::new(properties)))
            .map_err(|error| refused(file, &error))?;
        Ok(Self { writer })
    }

    fn write(&mut self, columns: &Columns, rows: &[String]) -> Result<(), ParquetError> {
        let cells: Vec<Vec<&str>> = rows.iter().map(|row| row.split(',').collect()).collect();
        let mut group = self.writer.next_row_group()?;
        for (index, (name, content)) in columns.all.iter().enumerate() {
            let column = cells.iter().map(|row| row.get(index).copied().unwrap_or_default());
            write_column(&mut group, name, *content, column)?;
        }
        group.close()?;
        Ok(())
    }
}

/// A column whose empty cells are nulls.
fn write_column<'a>(
    group: &mut SerializedRowGroupWriter<File>,
    name: &str,
    content: Content,
    cells: impl Iterator<Item = &'a str>,
) -> Result<(), ParquetError> {
    let cells: Vec<&str> = cells.collect();
    let levels: Vec<i16> = cells.iter().map(|cell| i16::from(!cell.is_empty())).collect();
    let filled = cells.into_iter().filter(|cell| !cell.is_empty());
    let wrong = |cell: &str| ParquetError::General(format!("{name}: `{cell}` is no number"));
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General(format!("{name}: is no column of the schema")));
    };
    match content {
        Content::Whole => {
            let numbers: Vec<i64> = filled
                .map(|cell| cell.parse().map_err(|_| wrong(cell)))
                .collect::<Result<_, _>>()?;
            column.typed::<Int64Type>().write_batch(&numbers, Some(&levels), None)?;
        }
        Content::Number => {
            let numbers: Vec<f64> = filled
                .map(|cell| cell.parse().map_err(|_| wrong(cell)))
                .collect::<Result<_, _>>()?;
            column.typed::<DoubleType>().write_batch(&numbers, Some(&levels), None)?;
        }
        Content::Text => {
            let texts: Vec<ByteArray> = filled.map(ByteArray::from).collect();
            column.typed::<ByteArrayType>().write_batch(&texts, Some(&levels), None)?;
        }
    }
    column.close()
}

fn schema(columns: &Columns) -> Result<TypePtr, ParquetError> {
    let field = |(name, content): &(String, Content)| {
        let physical = match content {
            Content::Whole => Physical::INT64,
            Content::Number => Physical::DOUBLE,
            Content::Text => Physical::BYTE_ARRAY,
        };
        let logical = (*content == Content::Text).then_some(LogicalType::String);
        let field = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(field))
    };
    let fields = columns.all.iter().map(field).collect::<Result<_, ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder("runs").with_fields(fields).build()?))
}
