//! Scenes that were dropped on the page: kept as files while the lab runs, each under what is in it.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pcs_sim::error::InputError;
use pcs_sim::run::{is_builtin, within};
use pcs_sim::scene::{self, ReadOptions};
use serde::Deserialize;
use serde_json::json;
use tempfile::TempDir;

use super::Lab;
use super::request::received;

/// How many are kept; an older one makes room.
const MOST: usize = 16;

/// Files that may come together.
const MOST_FILES: usize = 64;

/// Which of several files is the scene, the others being what it names.
const ENDINGS: [&str; 5] = ["ron", "cas", "nff", "obj", "ply"];

/// A scene's files, as the page sends them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sent {
    files: Vec<SentFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SentFile {
    name: String,
    base64: String,
}

/// The scenes that were taken.
#[derive(Debug)]
pub struct Uploads {
    folder: TempDir,
    max_bytes: usize,
    /// Their keys, from the oldest.
    kept: Mutex<VecDeque<String>>,
}

/// `POST /scenes`: takes a scene. What is wrong with it is told as the command tells it.
pub async fn take(State(lab): State<Arc<Lab>>, sent: Result<Json<Sent>, JsonRejection>) -> Response {
    let most = lab.uploads.max_bytes as f64 / 1e6;
    let too_long = || {
        let error = InputError::new(format!("the lab takes scenes of up to {most} Mbyte"));
        error.help("--max-upload makes it take larger ones")
    };
    let sent = match received(&lab, sent, too_long) {
        Ok(sent) => sent,
        Err(refusal) => return refusal.into_response(),
    };
    let taken = tokio::task::spawn_blocking(move || {
        let taken = lab.uploads.take(&sent);
        taken.map_err(|error| lab.refusal(error))
    });
    match taken.await {
        Ok(Ok(told)) => Json(told).into_response(),
        Ok(Err(refusal)) => (StatusCode::UNPROCESSABLE_ENTITY, refusal).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

impl Uploads {
    /// None yet; the largest that is taken has so many bytes.
    pub fn new(max_bytes: usize) -> Result<Uploads, InputError> {
        let folder = tempfile::Builder::new().prefix("pcs-sim-lab-").tempdir();
        let folder = folder.map_err(|error| InputError::new(format!("there is no room for scenes: {error}")))?;
        Ok(Uploads { folder, max_bytes, kept: Mutex::default() })
    }

    /// Where they are, until the lab ends.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Bytes that are read of a request: files take a third more as text.
    pub fn most_sent(&self) -> usize {
        self.max_bytes / 3 * 4 + 4096
    }

    /// A scene as it is read: a built-in one by its name, and the file of one that was taken, which is asked for by its key and the
    /// file's own name.
    pub fn scene(&self, asked: String) -> Result<String, InputError> {
        if is_builtin(&asked) {
            return Ok(asked);
        }
        let is_kept = asked.split_once('/').is_some_and(|(key, name)| {
            self.lock().iter().any(|kept| kept == key) && is_plain(name) && self.folder().join(key).join(name).is_file()
        });
        if !is_kept {
            let name = asked.rsplit('/').next().unwrap_or(&asked);
            let error = InputError::new(format!("the scene {name} is not at hand"));
            return Err(error.help("drop the file on the page: it gets the same address again"));
        }
        Ok(self.folder().join(asked).display().to_string())
    }

    /// A text that names files as their user does: without the folder of the lab and the key in it.
    pub fn as_named(&self, text: &str) -> String {
        let folder = self.folder().join("").display().to_string();
        let mut parts = text.split(&folder);
        let before = parts.next().unwrap_or_default().to_owned();
        parts.fold(before, |named, part| named + part.split_once('/').map_or(part, |(_, name)| name))
    }

    fn take(&self, sent: &Sent) -> Result<serde_json::Value, InputError> {
        let files = self.files(sent)?;
        let main = main_of(&files)?.to_owned();
        let mut hasher = blake3::Hasher::new();
        for (name, bytes) in &files {
            hasher.update(&(name.len() as u64).to_le_bytes()).update(name.as_bytes());
            hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
        }
        let key = hasher.finalize().to_hex()[..12].to_owned();
        let place = self.folder().join(&key);
        let failed = |error: std::io::Error| InputError::new(format!("the scene cannot be kept: {error}"));
        if !self.lock().contains(&key) {
            // Whoever asks for it meanwhile finds all of it or nothing.
            let part = tempfile::tempdir_in(self.folder()).map_err(failed)?;
            for (name, bytes) in &files {
                std::fs::write(part.path().join(name), bytes).map_err(failed)?;
            }
            check(part.path(), &main)?;
            let part = part.keep();
            if std::fs::rename(&part, &place).is_err() {
                // Another tab was faster with the same.
                let _ = std::fs::remove_dir_all(&part);
            }
            self.note(key.clone());
        }
        Ok(json!({ "scene": format!("{key}/{main}") }))
    }

    /// The files that were sent.
    fn files(&self, sent: &Sent) -> Result<Vec<(String, Vec<u8>)>, InputError> {
        if sent.files.is_empty() || sent.files.len() > MOST_FILES {
            return Err(InputError::new(format!("a scene is of 1 to {MOST_FILES} files")));
        }
        let file = |file: &SentFile| {
            if !is_plain(&file.name) {
                return Err(InputError::new(format!("{:?} is no name of a file", file.name)));
            }
            let bytes = STANDARD.decode(&file.base64);
            Ok((file.name.clone(), bytes.map_err(|error| InputError::new(format!("{}: {error}", file.name)))?))
        };
        sent.files.iter().map(file).collect()
    }

    /// Notes one that was taken, and drops the oldest if they are too many.
    fn note(&self, key: String) {
        let mut kept = self.lock();
        kept.retain(|other| *other != key);
        kept.push_back(key);
        while kept.len() > MOST {
            if let Some(oldest) = kept.pop_front() {
                let _ = std::fs::remove_dir_all(self.folder().join(oldest));
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<String>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads a scene once, and nothing that did not come with it, so that whoever reads it later needs no such care: its files stay
/// as they are.
fn check(folder: &Path, main: &str) -> Result<(), InputError> {
    within(folder, || scene::load(&folder.join(main), &ReadOptions::default()).map(drop))
}

/// The scene among some files.
fn main_of(files: &[(String, Vec<u8>)]) -> Result<&str, InputError> {
    let ending = |name: &str| {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase());
        ENDINGS.iter().position(|known| ending.as_deref() == Some(known))
    };
    let best = files.iter().filter_map(|(name, _)| Some((ending(name)?, name))).min_by_key(|(rank, _)| *rank);
    // Alone, it is told what is wrong with its name.
    best.map(|(_, name)| name.as_str())
        .or(files.first().map(|(name, _)| name.as_str()))
        .ok_or_else(|| InputError::new("no file"))
}

/// Whether a name is one of a file, not a way to one.
fn is_plain(name: &str) -> bool {
    let is_way = |letter: char| matches!(letter, '/' | '\\' | ':') || letter.is_control();
    !name.is_empty() && name.len() <= 200 && !name.starts_with(['.', '-']) && !name.contains(is_way)
}
