//! `pcs-sim plot TABLE x=COLUMN y=COLUMN by=COLUMN -o NAME`: a picture of a table that is there already.

use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::input::is_stream;
use pcs_sim::report::plot::curves::{self, Choice};
use pcs_sim::report::plot::{Format, Rendered};
use pcs_sim::report::table::{StoredTable, Table};
use pcs_sim::run::OutputFile;
use pcs_sim::sweep;

use super::args::PlotArgs;
use super::{Failure, outputs, print};

/// Draws the columns.
pub fn plot(args: &PlotArgs) -> Result<(), Failure> {
    let table = StoredTable::read(&args.table, sweep::label)?;
    let columns = table.columns();
    let choice = Choice::new(&args.columns, &columns)?;
    let drawn = choice.of(&Table { columns: &columns, rows: table.rows() });
    let what_ran = args.title.clone().unwrap_or_else(|| sweep::what_ran(&drawn));
    let files = Files::open(&args.output, &args.formats.plot_format, args.force)?;
    let rendered = curves::render(&drawn, &choice.axes, &choice.look, &what_ran)
        .map_err(|error| InputError::in_file(&args.table, error.to_string()))?;
    let mut written = Vec::new();
    files.write(&rendered, &mut written)?;
    print(&outputs::list(&written))
}

/// The files of a picture, opened before it is drawn.
pub struct Files(Vec<(OutputFile, Format)>);

impl Files {
    /// `name` with the ending of each format.
    pub fn open(name: &Path, formats: &[Format], force: bool) -> Result<Files, InputError> {
        let streamed = streamed(name)?;
        let formats = streamed.as_ref().map_or(formats, std::slice::from_ref);
        if is_stream(name) && formats.len() > 1 {
            let error =
                InputError::new(format!("standard output takes one picture, and {} are asked for", formats.len()));
            return Err(error.help("ask for one, as with -.svg or --plot-format svg, or name a file"));
        }
        let open = |&format: &Format| {
            let mut path = name.to_owned().into_os_string();
            path.push(format!(".{}", format.ending()));
            Ok((outputs::create(&PathBuf::from(path), force)?, format))
        };
        Ok(Files(formats.iter().map(open).collect::<Result<_, InputError>>()?))
    }

    /// Writes them.
    pub fn write(self, rendered: &Rendered, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        let mut files = self.0.into_iter();
        files.try_for_each(|(file, format)| {
            outputs::finish(Some(file), written, |file| std::io::Write::write_all(file, rendered.bytes(format)))
        })
    }
}

/// The format of a picture that goes to standard output, if its name tells it: `-.svg`.
fn streamed(name: &Path) -> Result<Option<Format>, InputError> {
    let Some(ending) = name.extension().filter(|_| is_stream(name)) else {
        return Ok(None);
    };
    let known = [Format::Svg, Format::Png, Format::Pdf].into_iter().find(|format| ending == format.ending());
    let error = || InputError::in_file(name, "is no name of a picture").help("pictures end in .svg, .png or .pdf");
    known.map(Some).ok_or_else(error)
}
