//! Rays from a file, in place of the camera's.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord};
use glam::Vec3;

use crate::error::InputError;
use crate::geometry::Ray;
use crate::input::fields;
use crate::input::text::{LARGEST_COORDINATE, Text, Token, coordinate, plural};

/// A direction's largest component must lie between this and its inverse.
const SHORTEST: f32 = 1e-15;

const COLUMNS: [&str; 7] = ["ox", "oy", "oz", "dx", "dy", "dz", "tmax"];

/// Reads a CSV file with the header `ox,oy,oz,dx,dy,dz` and optionally `tmax`, one ray a line.
pub fn read(path: &Path) -> Result<Vec<Ray>, InputError> {
    let source = fields::read_any_text(path)?;
    let text = Text { file: path, text: &source };
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(source.as_bytes());
    let mut record = StringRecord::new();
    let mut next = |record: &mut StringRecord| {
        reader.read_record(record).map_err(|error| InputError::in_file(path, format!("is no table: {error}")))
    };
    if !next(&mut record)? {
        return Err(InputError::in_file(path, "the file is empty: expected the header ox,oy,oz,dx,dy,dz"));
    }
    let columns = Line { text, record: &record }.columns()?;
    let mut rays = Vec::new();
    while next(&mut record)? {
        let line = Line { text, record: &record };
        if !line.is_blank() {
            rays.push(line.ray(columns)?);
        }
    }
    if rays.is_empty() {
        return Err(InputError::in_file(path, "the file has no rays, only a header"));
    }
    if u32::try_from(rays.len()).is_err() {
        return Err(InputError::in_file(path, "the file has more rays than can be numbered in 32 bits"));
    }
    Ok(rays)
}

/// A ray as its numbers have it: ox, oy, oz, dx, dy, dz, tmax. Fails if it is none that the array's 32 bits can take.
pub fn ray([ox, oy, oz, dx, dy, dz, t_max]: [f64; 7]) -> Result<Ray, String> {
    let vector = |x, y, z| Ok::<_, String>(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?));
    let (origin, direction) = (vector(ox, oy, oz)?, vector(dx, dy, dz)?);
    check_direction(direction)?;
    match t_max >= 0.0 {
        true => Ok(Ray { origin, direction, t_max: t_max as f32 }),
        false => Err(format!("a tmax of {t_max}, expected one of 0 or more, or inf")),
    }
}

fn check_direction(direction: Vec3) -> Result<(), String> {
    let length = direction.abs().max_element();
    if length == 0.0 {
        return Err("the direction is zero".to_owned());
    }
    if !(SHORTEST..=1.0 / SHORTEST).contains(&length) {
        let range = "the direction's largest component must lie between 1e-15 and 1e15";
        return Err(format!("{range} for the array's 32-bit arithmetic"));
    }
    Ok(())
}

/// A line of the file and the fields that it comes to.
struct Line<'a> {
    text: Text<'a>,
    record: &'a StringRecord,
}

impl<'a> Line<'a> {
    fn is_blank(&self) -> bool {
        self.record.len() == 1 && self.field(0).is_empty()
    }

    /// Number of columns that the header announces: 6, or 7 with tmax.
    fn columns(&self) -> Result<usize, InputError> {
        let columns = self.record.len();
        let names = self.record.iter().map(str::trim);
        if (6..=7).contains(&columns) && names.eq(COLUMNS[..columns].iter().copied()) {
            return Ok(columns);
        }
        Err(self.error("expected the header ox,oy,oz,dx,dy,dz or ox,oy,oz,dx,dy,dz,tmax"))
    }

    fn ray(&self, columns: usize) -> Result<Ray, InputError> {
        let found = self.record.len();
        if found != columns {
            let expected = plural(columns as u64, "number");
            return Err(self.error(format!("expected {expected}, as the header has names, and found {found}")));
        }
        let number = |index: usize| self.number(index);
        let origin = Vec3::new(number(0)?, number(1)?, number(2)?);
        let direction = Vec3::new(number(3)?, number(4)?, number(5)?);
        let t_max = if columns == 7 { self.t_max()? } else { f32::INFINITY };
        check_direction(direction).map_err(|why| self.error(why))?;
        Ok(Ray { origin, direction, t_max })
    }

    /// A coordinate. Read as 32 bits at once: by way of 64 it would be rounded twice.
    fn number(&self, index: usize) -> Result<f32, InputError> {
        match self.field(index).parse::<f32>() {
            Ok(number) if number.abs() <= LARGEST_COORDINATE as f32 => Ok(number),
            _ => self.text.coordinate(self.token(index)),
        }
    }

    fn t_max(&self) -> Result<f32, InputError> {
        match self.field(6).parse::<f32>() {
            Ok(number) if number >= 0.0 => Ok(number),
            _ => Err(self.text.error_at(self.token(6), "expected a tmax of 0 or more, or inf")),
        }
    }

    /// A field without the blanks around it.
    fn field(&self, index: usize) -> &'a str {
        self.record.get(index).unwrap_or("").trim()
    }

    /// A field where it stands in the file, which the reader of tables does not say: with its quotes, if it has any.
    fn token(&self, index: usize) -> Token<'a> {
        let line = self.source();
        let text = line.split(',').nth(index).unwrap_or(line).trim();
        Token { text, at: self.text.offset_of(text) }
    }

    /// The line as it stands in the file. The record's place may be that of empty lines before it.
    fn source(&self) -> &'a str {
        let start = self.record.position().map_or(0, |position| position.byte() as usize);
        let rest = self.text.text.get(start..).unwrap_or("").trim_start_matches(['\r', '\n']);
        rest.lines().next().unwrap_or("")
    }

    fn error(&self, message: impl Into<String>) -> InputError {
        let line = self.source();
        self.text.error_at(Token { text: line, at: self.text.offset_of(line) }, message)
    }
}
