//! The source that a report names for a figure, in a comment behind it, worked out from the tables:
//!
//! ```text
//! source  = product { ("+" | "-") product }
//! product = atom { ("*" | "/") atom }
//! atom    = "(" source ")" | NUMBER | given | cells
//! given   = ("paper" SECTION | "thesis" SECTION | "RTN" ISSUE | "chosen") NAME      a row of reports/given.csv
//! cells   = [min | max | median | sum | count] TABLE { CONDITION } COLUMN
//! ```
//!
//! The paper is RR-0992, the thesis Argence's on SKY; RTN, the Ray Tracing News of 1990; what was chosen stands in docs/machine.md, or on the page.
//! A table is a .csv file, named from the page's folder without its ending. Without one of the five words just one row must
//! meet the conditions. All parts are set off by spaces.

use std::path::Path;

use super::table::{Condition, Tables};

/// What the sources on a page are worked out from.
pub struct Sources<'a> {
    pub tables: &'a mut Tables,
    pub folder: &'a Path,
}

impl Sources<'_> {
    /// What a source says: a cell's text, or a number.
    pub fn value(&mut self, source: &str) -> Result<String, String> {
        let mut words = source.split_whitespace().collect::<Vec<_>>();
        words.reverse();
        if words.iter().all(|word| is_operator(word) || word.parse::<f64>().is_ok()) {
            return Err("a source needs more than numbers".to_owned());
        }
        let value = self.sum(&mut words)?;
        if words.is_empty() { Ok(value) } else { Err(format!("'{}' has no place there", words.last().unwrap_or(&""))) }
    }

    /// `words` are those to come, the next one last.
    fn sum(&mut self, words: &mut Vec<&str>) -> Result<String, String> {
        let mut value = self.product(words)?;
        while let Some(operator) = words.pop_if(|word| ["+", "-"].contains(word)) {
            value = combine(operator, &value, &self.product(words)?)?;
        }
        Ok(value)
    }

    fn product(&mut self, words: &mut Vec<&str>) -> Result<String, String> {
        let mut value = self.atom(words)?;
        while let Some(operator) = words.pop_if(|word| ["*", "/"].contains(word)) {
            value = combine(operator, &value, &self.atom(words)?)?;
        }
        Ok(value)
    }

    fn atom(&mut self, words: &mut Vec<&str>) -> Result<String, String> {
        if words.pop_if(|word| *word == "(").is_some() {
            let value = self.sum(words)?;
            return words.pop_if(|word| *word == ")").map(|_| value).ok_or("a parenthesis is open".to_owned());
        }
        let end = words.iter().rposition(|word| is_operator(word)).map_or(0, |at| at + 1);
        let mut atom = words.split_off(end);
        atom.reverse();
        match atom[..] {
            [] => Err("something is missing".to_owned()),
            [number] if number.parse::<f64>().is_ok() => Ok(number.to_owned()),
            ["paper" | "thesis" | "RTN" | "chosen", ..] => self.given(&atom),
            [how @ ("min" | "max" | "median" | "sum" | "count"), ref cells @ ..] => reduce(how, &self.cells(cells)?),
            _ => match &self.cells(&atom)?[..] {
                [cell] => Ok(cell.clone()),
                cells => Err(format!("{} rows are such", cells.len())),
            },
        }
    }

    fn given(&mut self, words: &[&str]) -> Result<String, String> {
        let [source @ .., name] = words else { return Err("a given figure has a name".to_owned()) };
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/given.csv");
        let conditions = [format!("source={}", source.join("_")), format!("name={name}")];
        let conditions: Vec<_> = conditions.iter().filter_map(|word| Condition::parse(word)).collect();
        match self.tables.get(&path)?.cells(&conditions, "value")?[..] {
            [value] => Ok(value.to_owned()),
            _ => Err("it is given more than once".to_owned()),
        }
    }

    fn cells(&mut self, words: &[&str]) -> Result<Vec<String>, String> {
        let [table, conditions @ .., column] = words else {
            return Err(format!("'{}' is no table with conditions and a column", words.join(" ")));
        };
        let parse = |word: &&str| Condition::parse(word).ok_or(format!("'{word}' is no condition"));
        let conditions = conditions.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
        let cells = self.tables.get(&self.folder.join(format!("{table}.csv")))?.cells(&conditions, column)?;
        Ok(cells.into_iter().map(str::to_owned).collect())
    }
}

/// The values that a source's conditions compare with: a sentence may speak of them beside the figure.
pub fn keys(source: &str) -> impl Iterator<Item = String> {
    source.split_whitespace().filter_map(Condition::parse).flat_map(|condition| condition.values().to_vec())
}

fn is_operator(word: &str) -> bool {
    ["+", "-", "*", "/", "(", ")"].contains(&word)
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| format!("'{text}' is no number"))
}

fn combine(operator: &str, a: &str, b: &str) -> Result<String, String> {
    let (a, b) = (number(a)?, number(b)?);
    Ok(match operator {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        _ => a / b,
    }
    .to_string())
}

fn reduce(how: &str, cells: &[String]) -> Result<String, String> {
    if how == "count" {
        return Ok(cells.len().to_string());
    }
    let mut numbers = cells.iter().map(|cell| number(cell)).collect::<Result<Vec<_>, _>>()?;
    numbers.sort_by(f64::total_cmp);
    let (low, high) = (numbers[(numbers.len() - 1) / 2], numbers[numbers.len() / 2]);
    Ok(match how {
        "min" => numbers[0],
        "max" => numbers[numbers.len() - 1],
        "sum" => numbers.iter().sum(),
        _ => (low + high) / 2.0,
    }
    .to_string())
}
