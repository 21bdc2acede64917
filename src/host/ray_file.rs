//! Rays from a file, in place of the camera's.

use std::path::Path;

use glam::Vec3;

use crate::error::InputError;
use crate::geometry::Ray;

/// Coordinates beyond this leave the range of 32-bit products.
const LARGEST: f32 = 1e15;
/// A direction's largest component must lie between this and its inverse.
const SHORTEST: f32 = 1e-15;

/// Reads a CSV file with the header `ox,oy,oz,dx,dy,dz` and optionally `tmax`, one ray a line.
pub fn read(path: &Path) -> Result<Vec<Ray>, InputError> {
    let text = crate::input::fields::read_text(path)?;
    let mut lines = text.lines().enumerate().map(|(index, line)| Line { path, number: index + 1, text: line });
    let header = lines
        .next()
        .ok_or_else(|| InputError::in_file(path, "the file is empty: expected the header ox,oy,oz,dx,dy,dz"))?;
    let columns = header.columns()?;
    let rays: Vec<Ray> =
        lines.filter(|line| !line.text.trim().is_empty()).map(|line| line.ray(columns)).collect::<Result<_, _>>()?;
    if rays.is_empty() {
        return Err(InputError::in_file(path, "the file has no rays, only a header"));
    }
    if u32::try_from(rays.len()).is_err() {
        return Err(InputError::in_file(path, "the file has more rays than can be numbered in 32 bits"));
    }
    Ok(rays)
}

struct Line<'a> {
    path: &'a Path,
    number: usize,
    text: &'a str,
}

impl Line<'_> {
    /// Number of columns that the header announces: 6, or 7 with tmax.
    fn columns(&self) -> Result<usize, InputError> {
        let names: Vec<&str> = self.text.split(',').map(str::trim).collect();
        let expected = ["ox", "oy", "oz", "dx", "dy", "dz", "tmax"];
        if (names.len() == 6 || names.len() == 7) && names == expected[..names.len()] {
            Ok(names.len())
        } else {
            Err(self.error(
                1,
                self.text.chars().count(),
                "expected the header ox,oy,oz,dx,dy,dz or ox,oy,oz,dx,dy,dz,tmax",
            ))
        }
    }

    fn ray(&self, columns: usize) -> Result<Ray, InputError> {
        let found = self.text.split(',').count();
        if found != columns {
            let message = format!("expected {columns} numbers, as the header has names, and found {found}");
            return Err(self.error(1, self.text.chars().count(), message));
        }
        let number = |index: usize| self.number_at(index);
        let origin = Vec3::new(number(0)?, number(1)?, number(2)?);
        let direction = Vec3::new(number(3)?, number(4)?, number(5)?);
        let t_max = if columns == 7 { self.t_max()? } else { f32::INFINITY };
        self.check(origin, direction)?;
        Ok(Ray { origin, direction, t_max })
    }

    fn number_at(&self, index: usize) -> Result<f32, InputError> {
        let (column, field) = self.field(index);
        match field.parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.error(column, field.chars().count(), format!("'{field}' is no finite number"))),
            Err(_) => Err(self.error(column, field.chars().count(), format!("expected a number, found '{field}'"))),
        }
    }

    fn t_max(&self) -> Result<f32, InputError> {
        let (column, field) = self.field(6);
        match field.parse::<f32>() {
            Ok(number) if number >= 0.0 => Ok(number),
            _ => Err(self.error(column, field.chars().count(), "expected a tmax of 0 or more, or inf")),
        }
    }

    fn check(&self, origin: Vec3, direction: Vec3) -> Result<(), InputError> {
        let length = direction.abs().max_element();
        let fault = if origin.abs().max_element() > LARGEST {
            "the origin is too far out for the array's 32-bit arithmetic: coordinates must stay within 1e15"
        } else if length == 0.0 {
            "the direction is zero"
        } else if !(SHORTEST..=1.0 / SHORTEST).contains(&length) {
            "the direction's largest component must lie between 1e-15 and 1e15 for the array's 32-bit arithmetic"
        } else {
            return Ok(());
        };
        Err(self.error(1, self.text.chars().count(), fault))
    }

    /// A field without the blanks around it, and its column from 1.
    fn field(&self, index: usize) -> (usize, &str) {
        let before: usize = self.text.split(',').take(index).map(|field| field.chars().count() + 1).sum();
        let raw = self.text.split(',').nth(index).unwrap_or("");
        let blanks = raw.chars().count() - raw.trim_start().chars().count();
        (before + blanks + 1, raw.trim())
    }

    fn error(&self, column: usize, width: usize, message: impl Into<String>) -> InputError {
        InputError::in_line(self.path, self.text, self.number, column, width, message)
    }
}
