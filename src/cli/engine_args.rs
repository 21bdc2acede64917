//! What can be typed for work that is cut into shards.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use pcs_sim::error::InputError;
use pcs_sim::run::{RecordingMemory, read_text};
use pcs_sim::shards::{Engine, Manner};

/// Shards, and what starts them.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Past one machine")]
pub struct EngineArgs {
    /// What the work runs on: this machine (local), an array of jobs of Slurm's (slurm), or machines that GNU parallel reaches
    /// by ssh (parallel). The results do not depend on it.
    #[arg(long, value_name = "ENGINE", value_enum, default_value_t = EngineName::Local)]
    pub engine: EngineName,
    /// Cut the work into about so many shards, a process each [default: 100].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub shards: Option<u32>,
    /// Run no more than so many shards at once [default: as many as the engine lets].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub at_once: Option<u32>,
    /// Start the shards and do not wait for them; `pcs-sim sweep status|collect|cancel FOLDER` goes on.
    #[arg(long)]
    pub detach: bool,
    /// Slurm: the account that the jobs are charged to.
    #[arg(long, value_name = "NAME")]
    pub slurm_account: Option<String>,
    /// Slurm: the partition of nodes.
    #[arg(long, value_name = "NAME")]
    pub slurm_partition: Option<String>,
    /// Slurm: the memory of each shard, such as 4G.
    #[arg(long, value_name = "SIZE")]
    pub slurm_memory: Option<String>,
    /// Slurm: the time that each shard may take, such as 1:30:00.
    #[arg(long, value_name = "TIME")]
    pub slurm_time: Option<String>,
    /// Slurm: any other argument of sbatch, such as --sbatch-arg=--qos=low. May be given several times.
    #[arg(long, value_name = "ARG", allow_hyphen_values = true)]
    pub sbatch_arg: Vec<String>,
    /// Slurm: a file of lines for the head of the script: #SBATCH lines, module load ...
    #[arg(long, value_name = "FILE")]
    pub sbatch_file: Option<PathBuf>,
    /// GNU parallel: the hosts, as its --sshlogin takes them: n1,n2 or 4/user@n1. May be given several times.
    #[arg(long, value_name = "HOSTS")]
    pub sshlogin: Vec<String>,
    /// GNU parallel: a file of hosts, one a line, as its --sshloginfile takes them.
    #[arg(long, value_name = "FILE")]
    pub hosts: Option<PathBuf>,
    /// GNU parallel: any other argument of parallel, such as --parallel-arg=--nice=10. May be given several times.
    #[arg(long, value_name = "ARG", allow_hyphen_values = true)]
    pub parallel_arg: Vec<String>,
}

/// What the work runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    Local,
    Slurm,
    Parallel,
}

/// What goes on with shards that were started.
#[derive(Clone, Debug, Subcommand)]
pub enum ShardsCommand {
    /// Tells how far the shards of a folder are.
    Status(FolderArgs),
    /// Joins what the shards of a folder have found: to the table, or to the image.
    Collect(CollectArgs),
    /// Ends the shards of a folder. What they have found stays, and the command that started them goes on from there.
    Cancel(FolderArgs),
    /// Does the work of one shard: what the engines call.
    Shard(ShardArgs),
}

#[derive(Clone, Debug, Args)]
pub struct FolderArgs {
    /// The folder: TABLE.shards for TABLE.csv.
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
}

#[derive(Clone, Debug, Args)]
pub struct CollectArgs {
    /// The folder: TABLE.shards for TABLE.csv.
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Do nothing if a process waits for the shards, which joins them itself, or has done so.
    #[arg(long)]
    pub unless_waited_for: bool,
}

#[derive(Clone, Debug, Args)]
pub struct ShardArgs {
    /// The folder: TABLE.shards for TABLE.csv.
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The number of the shard, from 0.
    #[arg(value_name = "NUMBER")]
    pub number: usize,
}

/// Shards of work for which nothing else is said.
const SHARDS: u32 = 100;

impl EngineArgs {
    /// The engine; `None` for this process.
    ///
    /// Fails if what is typed is for another engine.
    pub fn engine(&self) -> Result<Option<Engine>, InputError> {
        self.check()?;
        Ok(match self.engine {
            EngineName::Local => None,
            EngineName::Slurm => Some(Engine::Slurm { lines: self.sbatch_lines()? }),
            EngineName::Parallel => Some(Engine::Parallel { args: self.parallel_args()? }),
        })
    }

    /// How the shards work: with so many threads each, by default one.
    pub fn manner(&self, threads: Option<u16>, memory: Option<RecordingMemory>, overwrite: bool) -> Manner {
        let shards = self.shards.unwrap_or(SHARDS) as usize;
        Manner { shards, threads: threads.unwrap_or(1), memory, overwrite }
    }

    fn check(&self) -> Result<(), InputError> {
        let of_shards =
            [("--shards", self.shards.is_some()), ("--at-once", self.at_once.is_some()), ("--detach", self.detach)];
        let of_slurm = [
            ("--slurm-account", self.slurm_account.is_some()),
            ("--slurm-partition", self.slurm_partition.is_some()),
            ("--slurm-memory", self.slurm_memory.is_some()),
            ("--slurm-time", self.slurm_time.is_some()),
            ("--sbatch-arg", !self.sbatch_arg.is_empty()),
            ("--sbatch-file", self.sbatch_file.is_some()),
        ];
        let of_parallel = [
            ("--sshlogin", !self.sshlogin.is_empty()),
            ("--hosts", self.hosts.is_some()),
            ("--parallel-arg", !self.parallel_arg.is_empty()),
        ];
        let typed = |flags: &[(&'static str, bool)]| flags.iter().find(|(_, typed)| *typed).map(|(flag, _)| *flag);
        let (local, slurm) = (self.engine == EngineName::Local, self.engine == EngineName::Slurm);
        let strange = [
            (typed(&of_shards).filter(|_| local), "slurm or --engine parallel"),
            (typed(&of_slurm).filter(|_| !slurm), "slurm"),
            (typed(&of_parallel).filter(|_| local || slurm), "parallel"),
        ];
        match strange.into_iter().find_map(|(flag, engine)| Some((flag?, engine))) {
            Some((flag, engine)) => Err(InputError::new(format!("{flag} is for --engine {engine}"))),
            None => Ok(()),
        }
    }

    fn sbatch_lines(&self) -> Result<Vec<String>, InputError> {
        let named = [
            ("account", &self.slurm_account),
            ("partition", &self.slurm_partition),
            ("mem", &self.slurm_memory),
            ("time", &self.slurm_time),
        ];
        let named = named.into_iter().filter_map(|(name, value)| Some(format!("--{name}={}", value.as_ref()?)));
        let args: Vec<String> = named.chain(self.sbatch_arg.iter().cloned()).collect();
        if let Some(arg) = args.iter().find(|arg| arg.contains(['\n', '\r']) || !arg.starts_with('-')) {
            let error = InputError::new(format!("'{arg}' is no argument of sbatch"));
            return Err(error.help("write it as --sbatch-arg=--qos=low"));
        }
        let file = self.sbatch_file.as_deref().map(read_text).transpose()?.unwrap_or_default();
        let lines = args.into_iter().map(|arg| format!("#SBATCH {arg}"));
        Ok(lines.chain(file.lines().map(str::to_owned)).collect())
    }

    fn parallel_args(&self) -> Result<Vec<String>, InputError> {
        let hosts = self.sshlogin.iter().flat_map(|hosts| ["--sshlogin".to_owned(), hosts.clone()]);
        let mut args: Vec<String> = hosts.collect();
        if let Some(file) = &self.hosts {
            read_text(file)?;
            let folder = std::env::current_dir().unwrap_or_default();
            args.extend(["--sshloginfile".to_owned(), folder.join(file).to_string_lossy().into_owned()]);
        }
        args.extend(self.parallel_arg.iter().cloned());
        Ok(args)
    }
}
