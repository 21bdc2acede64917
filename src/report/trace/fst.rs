//! Fast signal traces.

use std::borrow::Cow;
use std::io::{Cursor, Error, Write};

use wavefst::{ChainCompression, FstWriter, GeomEntry, Header, ScopeType, SignalValue, VarDir, VarType};

use super::Trace;
use super::signals::{Change, Kind, Signals, StateNames, Value};
use super::time_scale::TimeScale;

pub fn write(trace: &Trace<'_>, scale: TimeScale, out: &mut impl Write) -> Result<(), Error> {
    // The format is written back and forth; a recording is small enough for memory.
    let bytes = in_memory(trace, scale).map_err(Error::other)?;
    out.write_all(&bytes)
}

fn in_memory(trace: &Trace<'_>, scale: TimeScale) -> wavefst::Result<Vec<u8>> {
    let names = StateNames::new(&trace.recording.topology.states);
    let signals = Signals::new(trace, &names);
    let mut writer = FstWriter::builder(Cursor::new(Vec::new()))
        .timescale_exponent(scale.exponent())
        .chain_compression(ChainCompression::Lz4)
        .build()?;
    let machine = trace.recording.topology.names.machine.as_str();
    writer.begin_scope(ScopeType::VcdModule, machine, None)?;
    let mut handles = Vec::new();
    for scope in &signals.scopes {
        writer.begin_scope(ScopeType::VcdModule, scope.name.as_str(), None)?;
        for signal in &scope.signals {
            let (kind, width) = match signal.kind {
                Kind::Text => (VarType::GenString, GeomEntry::Variable),
                Kind::Number(bits) => (VarType::VcdWire, GeomEntry::Fixed(bits)),
            };
            handles.push((writer.add_variable(kind, VarDir::Implicit, signal.name.as_str(), width)?, signal.kind));
        }
        writer.end_scope()?;
    }
    writer.end_scope()?;
    let window = &trace.recording.window;
    writer.write_header(Header {
        start_time: scale.start_of(window.start),
        end_time: scale.start_of(window.end),
        version: concat!("pcs-sim ", env!("CARGO_PKG_VERSION")).to_owned(),
        ..Header::default()
    })?;
    // The last value of a signal once more tells where the window ends.
    let end = signals.changes.last().map(|last| Change { at: window.end, ..*last });
    for change in signals.changes.iter().chain(&end) {
        let (handle, kind) = handles[change.signal];
        writer.emit_change(scale.start_of(change.at), handle, value(change.value, kind))?;
    }
    Ok(writer.finish()?.into_inner())
}

fn value(value: Value<'_>, kind: Kind) -> SignalValue<'_> {
    let width = if let Kind::Number(bits) = kind { bits as usize } else { 0 };
    match value {
        Value::Text(text) => SignalValue::Bytes(Cow::Borrowed(text.as_bytes())),
        Value::Number(number) => SignalValue::Vector(Cow::Owned(format!("{number:0width$b}"))),
        Value::Nothing => SignalValue::Vector(Cow::Owned("x".repeat(width))),
    }
}
