//! Value change dumps.

use std::io::{Error, Write};

use vcd::{IdCode, TimescaleUnit, VarType, Writer};

use super::Trace;
use super::signals::{Kind, Signals, StateNames, Value};
use super::time_scale::TimeScale;

pub fn write(trace: &Trace<'_>, scale: TimeScale, out: &mut impl Write) -> Result<(), Error> {
    let names = StateNames::new(&trace.recording.topology.states);
    let signals = Signals::new(trace, &names);
    let mut writer = Writer::new(out);
    writer.version(concat!("pcs-sim ", env!("CARGO_PKG_VERSION")))?;
    writer.comment(&format!("{}\n    {}", trace.caption.title, trace.caption.machine))?;
    writer.timescale(1, unit(scale))?;
    writer.add_module(&trace.recording.topology.names.machine)?;
    let mut ids = Vec::new();
    for scope in &signals.scopes {
        writer.add_module(&scope.name)?;
        for signal in &scope.signals {
            let (kind, bits) = match signal.kind {
                Kind::Text => (VarType::String, 1),
                Kind::Number(bits) => (VarType::Wire, bits),
            };
            ids.push(writer.add_var(kind, bits, &signal.name, None)?);
        }
        writer.upscope()?;
    }
    writer.upscope()?;
    writer.enddefinitions()?;
    let mut now = None;
    for change in &signals.changes {
        if now.replace(change.at) != Some(change.at) {
            writer.timestamp(scale.start_of(change.at))?;
        }
        write_value(&mut writer, ids[change.signal], change.value)?;
    }
    writer.timestamp(scale.start_of(trace.recording.window.end))
}

fn unit(scale: TimeScale) -> TimescaleUnit {
    match scale.exponent() {
        -9 => TimescaleUnit::NS,
        -12 => TimescaleUnit::PS,
        _ => TimescaleUnit::FS,
    }
}

fn write_value(writer: &mut Writer<impl Write>, id: IdCode, value: Value<'_>) -> Result<(), Error> {
    match value {
        Value::Text(text) => writer.change_string(id, text),
        // Leading zeros may be left out; as text it is several times as fast as bit by bit.
        Value::Number(number) => writeln!(writer.writer(), "b{number:b} {id}"),
        Value::Nothing => writer.change_vector(id, [vcd::Value::X]),
    }
}
