//! Running the command as a user does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for a test's files.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Puts a file into the folder.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        std::fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// The names of all files in the folder.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the command in the folder.
    pub fn run(&self, args: &str) -> Finished {
        run_in(self.0.path(), args)
    }
}

/// How a command ended.
pub struct Finished {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Finished {
    /// Stdout of a command that must have succeeded.
    #[track_caller]
    pub fn success(self) -> String {
        assert_eq!(self.status, 0, "{}", self.stderr);
        self.stdout
    }

    /// Stderr of a command that must have refused its input.
    #[track_caller]
    pub fn refused(self) -> String {
        assert_eq!(self.status, 2, "{}{}", self.stdout, self.stderr);
        assert_eq!(self.stdout, "", "nothing goes to stdout");
        self.stderr
    }

    /// Stderr of a command whose run must have failed.
    #[track_caller]
    pub fn failed(self) -> String {
        assert_eq!(self.status, 1, "{}{}", self.stdout, self.stderr);
        self.stderr
    }
}

/// Runs the command in any folder.
pub fn run_in(folder: &Path, args: &str) -> Finished {
    let command =
        Command::new(env!("CARGO_BIN_EXE_pcs-sim")).args(args.split_whitespace()).current_dir(folder).output();
    let Output { status, stdout, stderr } = command.unwrap();
    Finished {
        status: status.code().expect("it ended by itself"),
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
    }
}
