//! §3 and (3): the cost of filters and intersection tests.

/// What a kernel costs (Figure 7): so much to start a ray, and so much for each voxel or polygon. In any unit of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KernelTime {
    /// t_init: once a ray.
    pub start: f64,
    /// For each voxel (grid) or polygon (slabs, intersection).
    pub each: f64,
}

impl KernelTime {
    /// The time for a ray with so many voxels or polygons.
    pub fn of(&self, count: f64) -> f64 {
        self.start + self.each * count
    }
}

/// A filter, for an average ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// What it costs.
    pub time: KernelTime,
    /// How many voxels (grid) or polygons (slabs) it works on.
    pub steps: f64,
    /// Nb_i: how many polygons it lets through.
    pub passes: f64,
}

/// T = (T_filter1(P) + T_filter2(Nb_1) + ... + T_inter(Nb_n)) R, of §3. `polygons` is P, `rays` R.
pub fn time(filters: &[Filter], intersection: KernelTime, polygons: f64, rays: f64) -> f64 {
    let filtering: f64 = filters.iter().map(|filter| filter.time.of(filter.steps)).sum();
    let left = filters.last().map_or(polygons, |filter| filter.passes);
    (filtering + intersection.of(left)) * rays
}

/// T_0 to T_n: the time with none of the filters, with the first, and so on.
pub fn times(filters: &[Filter], intersection: KernelTime, polygons: f64, rays: f64) -> Vec<f64> {
    (0..=filters.len()).map(|count| time(&filters[..count], intersection, polygons, rays)).collect()
}

/// Property (1): T_0 > T_1 > ... > T_n, so that every filter pays.
pub fn property_1(times: &[f64]) -> bool {
    times.windows(2).all(|pair| pair[0] > pair[1])
}

/// Equation (3): T = (t_init + nb_steps t_step + nb_filter1 t_inter) R, with a grid and nothing else.
pub fn time_with_grid(grid: KernelTime, steps: f64, candidates: f64, t_inter: f64, rays: f64) -> f64 {
    (grid.of(steps) + candidates * t_inter) * rays
}
