//! Which of the points of their edges polygons have.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How the intersection tells the inside of a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edges {
    /// As annex A.3 does, polygon by polygon: a ray that is aimed at an edge of two polygons may pass between them.
    #[default]
    Paper,
    /// So that none does.
    Closed,
}

impl FromStr for Edges {
    type Err = String;

    fn from_str(name: &str) -> Result<Edges, String> {
        match name {
            "paper" => Ok(Edges::Paper),
            "closed" => Ok(Edges::Closed),
            _ => Err("expected one of paper, closed".to_owned()),
        }
    }
}

impl fmt::Display for Edges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Edges::Paper => "paper",
            Edges::Closed => "closed",
        })
    }
}
