//! The graphs of a run as files.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use pcs_sim::error::InputError;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::report::graphs::{Asked, Format, Graphs, Of, PixelWindow};
use pcs_sim::run::{OutputFile, OutputFolder, Watching};

use super::{Failure, outputs};

/// What can be asked of graphs.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Results")]
pub struct GraphArgs {
    /// Write the graphs of the run: G_r of the scene's parts, G_v of the rays, G_p of host and cells, and what was known of them before.
    #[arg(long, value_name = "DIR")]
    pub graphs: Option<PathBuf>,
    /// What the graphs are written as.
    #[arg(long, value_name = "FORMAT,...", value_enum, value_delimiter = ',', default_values_t = [Format::Graphml], requires = "graphs")]
    pub graph_format: Vec<Format>,
    /// What G_r has beside the parts of the scene.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Of::Regions, requires = "graphs")]
    pub graph_of: Of,
    /// Let G_v have each ray of these pixels, at most 10 000, in place of their numbers by kind and generation: 10..20,40..44.
    #[arg(long, value_name = "X0..X1,Y0..Y1", requires = "graphs")]
    pub graph_pixels: Option<PixelWindow>,
}

/// The files of graphs, opened before the run: for each format those of G_r, G_v and G_p; and what was known of them.
pub struct GraphFiles {
    graphs: Vec<(Format, [OutputFile; 3])>,
    classification: OutputFile,
    asked: Asked,
    /// Removed if nothing comes to lie in it.
    _folder: OutputFolder,
}

impl GraphFiles {
    /// Opens the files, if graphs are asked for.
    pub fn open(args: &GraphArgs, force: bool) -> Result<Option<GraphFiles>, InputError> {
        let Some(folder) = args.graphs.as_deref() else { return Ok(None) };
        let failed = |error: std::io::Error| {
            let reason = format!("cannot be a folder for graphs: {error}");
            InputError::in_file(folder, reason).help("name a folder, or a new name for one")
        };
        let made = outputs::folder(folder).map_err(failed)?;
        let create = |name: &str| outputs::create(&made.path().join(name), force);
        let mut formats = args.graph_format.clone();
        formats.sort_unstable_by_key(|format| format.extension());
        formats.dedup();
        let of = |format: Format| {
            let open = |name: &str| create(&format!("{name}.{}", format.extension()));
            Ok((format, [open("G_r")?, open("G_v")?, open("G_p")?]))
        };
        let asked = Asked { of: args.graph_of, pixels: args.graph_pixels };
        let graphs = formats.into_iter().map(of).collect::<Result<_, InputError>>()?;
        let classification = create("classification.json")?;
        Ok(Some(GraphFiles { graphs, classification, asked, _folder: made }))
    }

    /// What is asked of the graphs.
    pub fn asked(&self) -> &Asked {
        &self.asked
    }

    /// Writes the graphs.
    pub fn write(self, graphs: &Graphs, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        for (format, files) in self.graphs {
            for (file, graph) in files.into_iter().zip(graphs.all()) {
                outputs::finish(Some(file), written, |file| file.write_all(format.write(graph).as_bytes()))?;
            }
        }
        outputs::finish(Some(self.classification), written, |file| file.write_all(graphs.classification.as_bytes()))
    }
}

/// What is watched of a run whose graphs are asked for, if they are, beside what other results want.
pub fn watching(files: Option<&GraphFiles>, others: Watching) -> Watching {
    let spans = files.is_some_and(|files| files.asked.watching().spans);
    Watching { spans, ..others }
}

/// Fails if the pixels whose rays are asked for are not those of an image of that size.
pub fn check(args: &GraphArgs, size: ImageSize) -> Result<(), InputError> {
    args.graph_pixels.map_or(Ok(()), |window| window.check(size))
}
