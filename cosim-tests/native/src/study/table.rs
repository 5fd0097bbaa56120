//! A study's rows as one table: `results.csv` and `results.parquet`, a row a run in order, and the latter's columns
//! one by one. The only file that names the Parquet library.

use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnDescPtr, Type, TypePtr};

use super::StudyError;
use super::campaign::Campaign;
use super::data::Words;
use super::row::{Columns, Content};
use super::shard::{self, BUILD, VERSION};
use crate::whole_file::{self, temporary};

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
    // Open until they have their names, so that nobody takes them for leftovers.
    let open = |part: &Path| {
        whole_file::create(part)
            .map_err(|source| StudyError::File { file: part.to_owned(), source })
    };
    let (csv, parquet) = (open(&csv_part)?, open(&parquet_part)?);
    let merged = write(campaign, (&csv_part, &csv), (&parquet_part, &parquet)).and_then(|()| {
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

fn write(
    campaign: &Campaign,
    (csv, csv_open): (&Path, &File),
    (parquet, parquet_open): (&Path, &File),
) -> Result<(), StudyError> {
    let lost = |source| StudyError::File { file: csv.to_owned(), source };
    let wrong = |error: ParquetError| refused(parquet, &error);
    let columns = campaign.columns;
    let mut text = BufWriter::new(csv_open);
    let mut table = Table::create(campaign, parquet_open).map_err(wrong)?;
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

/// A merged table, read a column at a time: no more of it is ever in memory.
pub struct Reader {
    file: PathBuf,
    reader: SerializedFileReader<File>,
}

impl Reader {
    /// The table of a campaign; `None` if it has none yet.
    ///
    /// # Errors
    /// A table of another study or version, or none that can be read.
    pub fn open(campaign: &Campaign) -> Result<Option<Self>, StudyError> {
        let file = campaign.folder.join("results.parquet");
        let open = match File::open(&file) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(StudyError::File { file, source }),
            Ok(open) => open,
        };
        let reader = SerializedFileReader::new(open).map_err(|error| refused(&file, &error))?;
        let metadata = reader.metadata().file_metadata();
        let entry = |key: &str| {
            let entries = metadata.key_value_metadata().map(Vec::as_slice).unwrap_or_default();
            let found = entries.iter().find(|entry| entry.key == key);
            found.and_then(|entry| entry.value.clone()).unwrap_or_default()
        };
        let found = shard::origin(&entry("study_sha256"), &entry("version"), &entry("build"));
        let expected = campaign.study.origin();
        if found != expected {
            return Err(StudyError::Foreign { file, found, expected });
        }
        Ok(Some(Self { file, reader }))
    }

    /// A column of numbers, NaN where it is empty; `None` if there is none of that name that has numbers.
    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, StudyError> {
        self.column::<DoubleType, _>(name, |cell| cell.map_or(f64::NAN, |number| *number))
    }

    /// A column of words.
    pub fn words(&self, name: &str) -> Result<Option<Words>, StudyError> {
        let mut words = Words::default();
        let text = |cell: Option<&ByteArray>| {
            let text = cell.and_then(|bytes| bytes.as_utf8().ok()).unwrap_or_default();
            words.code(text)
        };
        let codes = self.column::<ByteArrayType, _>(name, text)?;
        Ok(codes.map(|codes| Words { codes, ..words }))
    }

    fn column<T: DataType, V>(
        &self,
        name: &str,
        mut value: impl FnMut(Option<&T::T>) -> V,
    ) -> Result<Option<Vec<V>>, StudyError> {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        let of_type = |column: &ColumnDescPtr| column.physical_type() == T::get_physical_type();
        let mut columns = schema.columns().iter();
        let found = columns.position(|column| column.name() == name && of_type(column));
        let Some(index) = found else { return Ok(None) };
        let mut values = Vec::with_capacity(self.rows());
        let mut read = || {
            for group in 0..self.reader.num_row_groups() {
                let group = self.reader.get_row_group(group)?;
                let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
                let mut column = get_typed_column_reader::<T>(group.get_column_reader(index)?);
                let (mut levels, mut filled) = (Vec::new(), Vec::new());
                column.read_records(rows, Some(&mut levels), None, &mut filled)?;
                let mut filled = filled.iter();
                values.extend(levels.iter().map(|level| match level {
                    0 => value(None),
                    _ => value(filled.next()),
                }));
            }
            Ok(())
        };
        read().map_err(|error: ParquetError| refused(&self.file, &error))?;
        Ok(Some(values))
    }

    pub fn rows(&self) -> usize {
        usize::try_from(self.reader.metadata().file_metadata().num_rows()).unwrap_or(0)
    }
}

struct Table<'a> {
    writer: SerializedFileWriter<&'a File>,
}

impl<'a> Table<'a> {
    fn create(campaign: &Campaign, open: &'a File) -> Result<Self, ParquetError> {
        let study = campaign.study;
        let entry = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("lander {VERSION}"))
            .set_key_value_metadata(Some(vec![
                entry("study", study.name.clone()),
                entry("study_sha256", study.hash.clone()),
                entry("version", VERSION.to_owned()),
                entry("build", BUILD.to_owned()),
                entry("seed", study.seed.to_string()),
            ]))
            .build();
        let writer =
            SerializedFileWriter::new(open, schema(campaign.columns)?, Arc::new(properties))?;
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
    group: &mut SerializedRowGroupWriter<&File>,
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
