//! What a machine makes of values that are no whole number of its cycles: columns beside the values that were asked.

use super::parameters::{Parameter, Points};
use crate::machine::{Capitan, Ipsc2, Machine};
use crate::report::table::{Column, Kind};

/// The value that a machine has in place of one that was asked.
pub struct Effective<M> {
    pub column: Column<'static>,
    /// The parameters on which it depends beside the machine file and the clock.
    asked: &'static [&'static str],
    /// Whether it is told where one of these is set, and not where just the clock or the machine file are.
    seldom: bool,
    pub of: fn(&M) -> u64,
}

macro_rules! effective {
    ($($name:literal of $asked:expr, $label:literal: $of:expr;)* $(seldom $rare:literal of $of_rare:expr, $rare_label:literal: $rarely:expr;)*) => {
        [
            $(Effective { column: Column::new($name, Kind::Whole, $label), asked: &$asked, seldom: false, of: $of },)*
            $(Effective { column: Column::new($rare, Kind::Whole, $rare_label), asked: &$of_rare, seldom: true, of: $rarely },)*
        ]
    };
}

/// Those of an array.
pub(super) const OF_ARRAYS: [Effective<Machine>; 12] = effective! {
    "link_cycles_per_word" of ["link_mb_s", "word_bytes"], "link, as simulated (cycles a word)":
        |machine| machine.spec.link_rate().cycles_per_word;
    "host_ray_cycles" of ["host_ray_us"], "host's time for sending a ray, as simulated (cycles)":
        |machine| machine.times.host.ray.0;
    "host_hit_cycles" of ["host_hit_us"], "host's time for shading a hit, as simulated (cycles)":
        |machine| machine.times.host.hit.0;
    "grid_start_cycles" of ["grid_start"], "grid: start of a ray, as simulated (cycles)":
        |machine| machine.times.grid.start.0;
    "grid_voxel_cycles" of ["grid_voxel"], "grid: step to a voxel, as simulated (cycles)":
        |machine| machine.times.grid.each.0;
    "slabs_start_cycles" of ["slabs_start"], "slabs: start of a ray, as simulated (cycles)":
        |machine| machine.times.slabs.start.0;
    "slabs_polygon_cycles" of ["slabs_polygon"], "slabs: test of a polygon, as simulated (cycles)":
        |machine| machine.times.slabs.each.0;
    "intersection_start_cycles" of ["intersection_start"], "intersection: start of a ray, as simulated (cycles)":
        |machine| machine.times.intersection.start.0;
    "intersection_polygon_cycles" of ["intersection_polygon"], "intersection: test of a polygon, as simulated (cycles)":
        |machine| machine.times.intersection.each.0;
    seldom "host_filter_cycles" of ["host_filter_us"], "host's time for testing a sample, as simulated (cycles)":
        |machine| machine.times.host.filter.0;
    seldom "host_mask_cycles" of ["host_mask_us"], "host's time for testing a sub-volume, as simulated (cycles)":
        |machine| machine.times.host.mask.0;
    seldom "message_cycles" of ["message_us"], "sending or taking a message, as simulated (cycles)":
        |machine| machine.times.message.unwrap_or_default().0;
};

/// Those of a farm. Its times are in ns, and seldom rounded.
pub(super) const OF_FARMS: [Effective<Capitan>; 1] = effective! {
    "bus_ps_per_byte" of ["bus_mb_s"], "bus, as simulated (ps a byte)": |machine| machine.buses.byte_millicycles();
};

/// Those of a hypercube.
pub(super) const OF_CUBES: [Effective<Ipsc2>; 6] = effective! {
    "byte_millicycles" of ["byte_us"], "byte of a message, as simulated (thousandths of a cycle)":
        |machine| machine.wires.byte_millicycles;
    "short_cycles" of ["short_us", "short_wire_us"], "short message at either end, as simulated (cycles)":
        |machine| machine.messages.short.0;
    "long_cycles" of ["long_us", "long_wire_us"], "long message at either end, as simulated (cycles)":
        |machine| machine.messages.long.0;
    "lookup_cycles" of ["lookup_us"], "access to another's page, as simulated (cycles)":
        |machine| machine.costs.lookup.0;
    "grid_voxel_cycles" of ["grid_voxel"], "grid: step to a voxel, as simulated (cycles)":
        |machine| machine.times.grid.each.0;
    "shade_hit_cycles" of ["shade_hit"], "shading a hit, as simulated (cycles)": |machine| machine.times.host.hit.0;
};

/// On these depend all of them.
const OF_ALL: [&str; 2] = ["clock_ns", "machine"];

impl<M> Effective<M> {
    /// Whether a sweep sets something on which it depends.
    pub fn is_asked(&self, parameters: &[Parameter]) -> bool {
        let depends = |parameter: &Parameter| {
            let name = parameter.column.name;
            self.asked.contains(&name) || OF_ALL.contains(&name) && !self.seldom
        };
        parameters.iter().any(depends)
    }
}

/// The columns of a sweep with these parameters.
pub(super) fn columns(of: Points, parameters: &[Parameter]) -> Vec<Column<'static>> {
    match of {
        Points::Arrays => asked(&OF_ARRAYS, parameters).map(|effective| effective.column).collect(),
        Points::Farms => asked(&OF_FARMS, parameters).map(|effective| effective.column).collect(),
        Points::Cubes => asked(&OF_CUBES, parameters).map(|effective| effective.column).collect(),
    }
}

/// All columns that sweeps can have.
pub(super) fn all() -> impl Iterator<Item = Column<'static>> {
    let of_arrays = OF_ARRAYS.into_iter().map(|effective| effective.column);
    let of_farms = OF_FARMS.into_iter().map(|effective| effective.column);
    of_arrays.chain(of_farms).chain(OF_CUBES.into_iter().map(|effective| effective.column))
}

/// The cells of these columns.
pub(super) fn cells<M>(all: &'static [Effective<M>], parameters: &[Parameter], machine: &M) -> Vec<String> {
    asked(all, parameters).map(|effective| (effective.of)(machine).to_string()).collect()
}

fn asked<'a, M>(
    all: &'static [Effective<M>],
    parameters: &'a [Parameter],
) -> impl Iterator<Item = &'static Effective<M>> + 'a {
    all.iter().filter(move |effective| effective.is_asked(parameters))
}
