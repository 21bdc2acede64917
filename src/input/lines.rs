//! Text that people read, in lines that fit.

/// Columns that terminals and printed logs have.
pub const WIDTH: usize = 80;

/// The words of a line, in as many lines of up to so many characters as they need.
pub fn wrapped(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return line.to_owned();
    }
    let mut lines = vec![String::new()];
    for word in words(line) {
        let last = lines.len() - 1;
        let taken = lines[last].chars().count();
        if taken > 0 && taken + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            let gap = if taken > 0 { " " } else { "" };
            lines[last] = format!("{}{gap}{word}", lines[last]);
        }
    }
    lines.join("\n")
}

/// The words of a line. What a space sets off within a number, and before its unit, belongs to it.
fn words(line: &str) -> Vec<&str> {
    let is_digit = |at: usize| line.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
    let mut words = Vec::new();
    let mut from = 0;
    for (at, _) in line.match_indices(' ') {
        let in_number = at > 0 && is_digit(at - 1) && (line[at + 1..].starts_with('%') || is_digit(at + 1));
        if !in_number {
            words.push(&line[from..at]);
            from = at + 1;
        }
    }
    words.push(&line[from..]);
    words
}

/// A number with its thousands set off: `262 144`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|g| std::str::from_utf8(g).ok()).collect();
    groups.join(" ")
}

/// So many things: `1 ray`, `262 144 rays`.
pub fn plural(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{} {noun}s", grouped(count)) }
}
