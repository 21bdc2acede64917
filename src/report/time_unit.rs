//! Times in the unit that suits them.

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeUnit {
    /// Its length.
    pub seconds: f64,
    /// Its symbol.
    pub name: &'static str,
}

impl TimeUnit {
    /// The largest unit of which a time has at least one.
    pub fn of(seconds: f64) -> TimeUnit {
        let (seconds, name) = match seconds {
            s if s >= 1.0 => (1.0, "s"),
            s if s >= 1e-3 => (1e-3, "ms"),
            s if s >= 1e-6 => (1e-6, "µs"),
            _ => (1e-9, "ns"),
        };
        TimeUnit { seconds, name }
    }
}
