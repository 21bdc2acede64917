//! Stand-in for the built-in scenes, to be replaced by the module of the same name.

use super::Scene;
use crate::error::InputError;

/// Always an error: there are no built-in scenes yet.
pub fn generate(name: &str, _size: Option<u32>, _resolution: u32) -> Result<Scene, InputError> {
    Err(InputError::new(format!("unknown built-in scene `{name}`")))
}
