//! The numbers in a page's sentences, each with the source that the page names for it.
//!
//! A comment, `<!-- SOURCE -->`, which is not seen on the page, speaks of the last number before it. A number without a
//! comment of its own must be a key of the comment before or behind it in the same paragraph, as the 16 of "0.254 with 16
//! cells". Text between backquotes, targets of links and numbers in names (P1, iPSC/2, Figure 7, §2)
//! are none.

use super::source::{Sources, keys};

/// A number in a sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// As it stands there, without the spaces between digits; two with an x between them are one.
    pub shown: String,
    /// What the page shows one of: 0.01 before a percent sign, 10^6 before "million" and "Mwords", else 1.
    pub unit: f64,
    /// The comment that speaks of it.
    pub source: Option<String>,
    /// The comments before and behind it, if none speaks of it.
    pub beside: Vec<String>,
}

impl Figure {
    /// Whether `shown` in its place would be true.
    pub fn check(&self, shown: &str, sources: &mut Sources) -> Result<(), String> {
        let Some(source) = &self.source else {
            let is_key = self.beside.iter().flat_map(|source| keys(source)).any(|key| is_rounded(shown, &key, 1.0));
            return if is_key { Ok(()) } else { Err(format!("nothing says where {shown} is from")) };
        };
        let value = sources.value(source).map_err(|error| format!("{shown}, from {source}: {error}"))?;
        if is_rounded(shown, &value, self.unit) { Ok(()) } else { Err(format!("{shown} is {value} in {source}")) }
    }
}

/// Whether a number is another, rounded to the digits that it shows.
pub fn is_rounded(shown: &str, exact: &str, unit: f64) -> bool {
    let digits = shown.split_once('.').map_or(0, |(_, fraction)| fraction.len() as i32);
    match (shown.parse::<f64>(), exact.parse::<f64>()) {
        // The products and quotients of decimal fractions are not exact in binary.
        (Ok(shown), Ok(exact)) => {
            let in_last_digits = |value: f64| value * 10f64.powi(digits);
            (in_last_digits(exact / unit) + 0.5 + 1e-7).floor() == in_last_digits(shown).round()
        }
        _ => shown == exact,
    }
}

/// The sentences of a page, a paragraph each: without titles, pictures, code, and without tables but for rows that name sources.
pub fn paragraphs(page: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    let mut is_code = false;
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        let is_told = line.starts_with('|') && line.contains("<!--");
        let starts = line.is_empty()
            || line.starts_with('|')
            || line.starts_with("- ")
            || line.split(". ").next().is_some_and(|w| w.parse::<u32>().is_ok());
        if starts {
            found.push(String::new());
        }
        if !is_code
            && !line.is_empty()
            && (is_told || !line.starts_with(['|', '!', '`', '#']))
            && !line.starts_with("    ")
        {
            let is_numbered = starts && line.starts_with(|c: char| c.is_ascii_digit());
            let text = if is_numbered { line.split_once(". ").map_or("", |(_, text)| text) } else { line };
            let last = found.last_mut().expect("there is one from the start");
            last.push_str(text);
            last.push(' ');
        }
    }
    found.retain(|paragraph| !paragraph.trim().is_empty());
    found
}

/// A piece of a paragraph that matters here.
enum Piece {
    Number { shown: String, unit: f64 },
    Comment(String),
}

/// The numbers of a paragraph.
pub fn figures(paragraph: &str) -> Result<Vec<Figure>, String> {
    let mut figures: Vec<Figure> = Vec::new();
    let (mut last_comment, mut first_free) = (None::<String>, 0);
    for piece in pieces(paragraph)? {
        match piece {
            Piece::Number { shown, unit } => {
                figures.push(Figure { shown, unit, source: None, beside: last_comment.clone().into_iter().collect() });
            }
            Piece::Comment(source) => {
                let [before @ .., last] = &mut figures[first_free..] else {
                    return Err(format!("{source}: there is no number before the comment"));
                };
                last.source = Some(source.clone());
                before.iter_mut().for_each(|figure| figure.beside.push(source.clone()));
                first_free = figures.len();
                last_comment = Some(source);
            }
        }
    }
    Ok(figures)
}

fn pieces(paragraph: &str) -> Result<Vec<Piece>, String> {
    let mut found = Vec::new();
    let (mut rest, mut in_word) = (paragraph, false);
    while let Some(next) = rest.chars().next() {
        if let Some(comment) = rest.strip_prefix("<!--") {
            let (source, behind) = comment.split_once("-->").ok_or("a comment has no end")?;
            found.push(Piece::Comment(source.trim().to_owned()));
            (rest, in_word) = (behind, false);
        } else if let Some(behind) = behind_enclosed(rest, "`", "`").or_else(|| behind_enclosed(rest, "](", ")")) {
            (rest, in_word) = (behind, false);
        } else if next.is_ascii_digit() && !in_word {
            let (number, behind) = rest.split_at(number_length(rest));
            let before = &paragraph[..paragraph.len() - rest.len()];
            let is_name = before.ends_with('§') || before.ends_with("Figure ");
            if !is_name && !behind.starts_with(|c: char| c.is_alphabetic() || c == '_') {
                let is_negative = before.strip_suffix('-').is_some_and(|text| !text.ends_with(char::is_alphanumeric));
                let sign = if is_negative { "-" } else { "" };
                found.push(Piece::Number { shown: sign.to_owned() + &number.replace(' ', ""), unit: unit(behind) });
            }
            (rest, in_word) = (behind, false);
        } else {
            // "-3" is a number, "hybrid-3" and "iPSC/2" are words.
            in_word = next.is_alphanumeric() || in_word && ['-', '/', '_'].contains(&next);
            rest = &rest[next.len_utf8()..];
        }
    }
    Ok(found)
}

fn behind_enclosed<'a>(text: &'a str, open: &str, close: &str) -> Option<&'a str> {
    text.strip_prefix(open)?.split_once(close).map(|(_, behind)| behind)
}

/// How long the number is with which a text starts: `100 000`, `0.25`, `512 x 512`.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    let is_grouped = length <= 3;
    while is_grouped && text[length..].starts_with(' ') && digits(length + 1) == 3 {
        length += 4;
    }
    for join in [".", " x "] {
        let more = if text[length..].starts_with(join) { digits(length + join.len()) } else { 0 };
        length += if more > 0 { join.len() + more } else { 0 };
    }
    length
}

fn unit(behind: &str) -> f64 {
    let word = behind.trim_start();
    let starts = |words: &[&str]| words.iter().any(|start| word.starts_with(start));
    if starts(&["%"]) {
        0.01
    } else if starts(&["million", "Mwords"]) {
        1e6
    } else {
        1.0
    }
}
