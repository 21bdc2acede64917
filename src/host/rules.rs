//! Rules that spare tests and rays without changing a bit of any hit, after the chapter on graphs (A1 to A6).
//!
//! | rule | says | where it is sound |
//! | --- | --- | --- |
//! | `own` (A1, A2, A4a) | a ray does not hit what it starts on | of single polygons, where A.3's own line for the plane says so |
//! | `a4b` | a point outside the cone of shadow around an object's box is not shaded by it | where the cone's angle is below 90 degrees |
//! | `a4c` | a point inside the cone of shadow within a polygon is shaded by it | where A.3 says so, too, and nothing in the scene lets light through |

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The rules that a host goes by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Rules {
    /// A ray says in a word more which polygon it starts on, if it cannot hit that; the grid's cell then drops it.
    pub own: bool,
    /// A shadow ray is not sent that starts outside the cones of shadow of all objects.
    pub a4b: bool,
    /// A shadow ray is not sent that starts inside the cone of shadow of a large polygon.
    pub a4c: bool,
}

/// What stands for no rule.
const NONE: &str = "none";

impl Rules {
    fn named(self) -> [(&'static str, bool); 3] {
        [("own", self.own), ("a4b", self.a4b), ("a4c", self.a4c)]
    }
}

impl FromStr for Rules {
    type Err = String;

    /// `none`, `own`, `own+a4b`.
    fn from_str(text: &str) -> Result<Rules, String> {
        let mut rules = Rules::default();
        for name in text.split('+').filter(|_| text != NONE) {
            let known = match name {
                "own" => &mut rules.own,
                "a4b" => &mut rules.a4b,
                "a4c" => &mut rules.a4c,
                _ => {
                    let some = "own, a4b, a4c, several of them as in own+a4b, none";
                    return Err(format!("there is no rule '{name}'; there are: {some}"));
                }
            };
            if std::mem::replace(known, true) {
                return Err(format!("the rule '{name}' is named twice"));
            }
        }
        Ok(rules)
    }
}

impl fmt::Display for Rules {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named: Vec<&str> = self.named().into_iter().filter(|(_, is_on)| *is_on).map(|(name, _)| name).collect();
        f.write_str(if named.is_empty() { NONE.to_owned() } else { named.join("+") }.as_str())
    }
}

impl TryFrom<String> for Rules {
    type Error = String;

    fn try_from(text: String) -> Result<Rules, String> {
        text.parse()
    }
}

impl From<Rules> for String {
    fn from(rules: Rules) -> String {
        rules.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_read_as_they_are_written() {
        for number in 0..8 {
            let [own, a4b, a4c] = [0, 1, 2].map(|bit| number >> bit & 1 == 1);
            let rules = Rules { own, a4b, a4c };
            assert_eq!(rules.to_string().parse(), Ok(rules));
        }
        for wrong in ["", "own+own", "a3", "own+none", "OWN", "own,a4b"] {
            assert!(wrong.parse::<Rules>().is_err(), "{wrong}");
        }
    }
}
