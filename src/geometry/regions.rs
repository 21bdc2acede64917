//! Macro-regions: parts of one grid, cut so that each has equal work (RR-0992, §4.1).
//!
//! A *cell* is a block of whole columns of voxels along the volume's shortest axis; the two longer axes have a plane of cells. A *region*
//! is a rectangle of cells. No voxel is in two regions, so that a ray's walk through the regions is its walk through the grid.

use serde::{Deserialize, Serialize};

use super::bounds::Bounds;
use super::grid::Grid;

/// The plane of cells of a grid.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellPlane {
    /// Voxels along each axis of the grid.
    size: [u32; 3],
    /// The two axes along which there are cells.
    axes: [usize; 2],
    /// How many there are along each of them.
    cells: [u32; 2],
    /// Each column's cell, along both axes, where cells are not of one width.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    columns: Option<[Vec<u16>; 2]>,
}

/// A rectangle of cells: from the first to before the last, along both axes of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rectangle {
    /// Its first cell.
    pub low: [u32; 2],
    /// The cell behind its last.
    pub high: [u32; 2],
}

/// The plane of cells cut into regions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Regions {
    plane: CellPlane,
    rectangles: Vec<Rectangle>,
    /// Each cell's region.
    of_cell: Vec<u16>,
}

/// There are not enough cells for so many regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{regions} regions take at least as many cells, and there are {across} x {down}")]
pub struct TooFewCells {
    /// The regions that there were to be.
    pub regions: usize,
    /// Cells along one axis.
    pub across: u32,
    /// Cells along the other.
    pub down: u32,
}

impl CellPlane {
    /// The most cells along an axis.
    pub const MOST: u32 = 128;

    /// As many cells along an axis as can be numbered in two.
    const FINEST: u32 = 255;

    /// `cells` x `cells` of a grid, fewer where it has fewer voxels.
    pub fn new(grid: &Grid, cells: u32) -> CellPlane {
        CellPlane::of_width(grid, cells.clamp(1, CellPlane::MOST))
    }

    /// A cell for each column of voxels, or for a few where there are very many: what can be joined to cells of equal work.
    pub fn finest(grid: &Grid) -> CellPlane {
        CellPlane::of_width(grid, CellPlane::FINEST)
    }

    /// `cells` x `cells` of no grid.
    pub fn of_screen(cells: u32) -> CellPlane {
        let cells = [cells.clamp(1, CellPlane::MOST); 2];
        CellPlane { size: [cells[0], cells[1], 1], axes: [0, 1], cells, columns: None }
    }

    fn of_width(grid: &Grid, cells: u32) -> CellPlane {
        let (size, extent) = (grid.size(), grid.volume().extent());
        let shortest = (0..3).fold(2, |shortest, axis| if extent[axis] < extent[shortest] { axis } else { shortest });
        let axes = match shortest {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        };
        CellPlane { size, axes, cells: axes.map(|axis| size[axis].min(cells)), columns: None }
    }

    /// Cells along each of its two axes.
    pub fn size(&self) -> [u32; 2] {
        self.cells
    }

    /// Its two axes, by their numbers.
    pub fn axes(&self) -> [usize; 2] {
        self.axes
    }

    /// The number of the cell that holds a voxel: along the first axis they run fastest.
    #[inline]
    fn cell_of(&self, voxel: usize) -> usize {
        let [x, y, _] = self.size.map(|side| side as usize);
        let at = [voxel % x, voxel / x % y, voxel / x / y];
        let along = |place: usize| self.cell_along(place, at[self.axes[place]]);
        along(0) + self.cells[0] as usize * along(1)
    }

    /// The cell of a column along one of the axes.
    #[inline]
    fn cell_along(&self, place: usize, column: usize) -> usize {
        match &self.columns {
            None => column * self.cells[place] as usize / self.size[self.axes[place]] as usize,
            Some(columns) => usize::from(columns[place][column]),
        }
    }

    /// Cells that are joined of these, of which `work` tells each one's, so that along either axis each of `cells` has an equal part of
    /// all work, as far as these allow. Returns also for each of these the one that it is in.
    pub fn quantiles(&self, work: &[u64], cells: u32) -> (CellPlane, Vec<u16>) {
        let [across, down] = self.cells.map(|side| side as usize);
        let mut sums = [vec![0u128; across], vec![0u128; down]];
        for (cell, &amount) in work.iter().enumerate() {
            sums[0][cell % across] += u128::from(amount);
            sums[1][cell / across] += u128::from(amount);
        }
        let joined = sums.map(|sums| equal_parts(&sums, cells.clamp(1, CellPlane::MOST) as usize));
        let counts = [0, 1].map(|place: usize| joined[place].last().map_or(1, |last| u32::from(*last) + 1));
        let of_column = |place: usize| {
            let columns = 0..self.size[self.axes[place]] as usize;
            columns.map(|column| joined[place][self.cell_along(place, column)]).collect()
        };
        let columns = Some([of_column(0), of_column(1)]);
        let place_of =
            |cell: usize| u32::from(joined[0][cell % across]) + counts[0] * u32::from(joined[1][cell / across]);
        let of_these = (0..across * down).map(|cell| place_of(cell) as u16).collect();
        (CellPlane { columns, cells: counts, ..self.clone() }, of_these)
    }

    /// Whether each column is in a cell, which may not be so of what was read from a file.
    fn is_whole(&self) -> bool {
        let fits = |(place, columns): (usize, &Vec<u16>)| {
            let size = self.axes.get(place).and_then(|&axis| self.size.get(axis));
            let rises = columns.windows(2).all(|pair| pair[1] == pair[0] || pair[1] == pair[0].saturating_add(1));
            size.is_some_and(|&size| size as usize == columns.len())
                && rises
                && columns.first() == Some(&0)
                && columns.last().is_some_and(|&last| u32::from(last) + 1 == self.cells[place])
        };
        self.columns.as_ref().is_none_or(|columns| columns.iter().enumerate().all(fits))
    }
}

/// For each of some places in a row, the part that it is in, of so many parts of equal sums; fewer where there are fewer places.
fn equal_parts(sums: &[u128], parts: usize) -> Vec<u16> {
    let parts = parts.min(sums.len()).max(1);
    let total: u128 = sums.iter().sum();
    let (mut part, mut before) = (0, 0u128);
    let mut of_place = Vec::with_capacity(sums.len());
    for (place, amount) in sums.iter().enumerate() {
        of_place.push(part as u16);
        before += amount;
        // The next place begins the next part if this one is full, or if each of the others needs a place of its own.
        let is_full = before * parts as u128 >= total * (part as u128 + 1);
        let is_needed = sums.len() - place - 1 < parts - part;
        if part + 1 < parts && (is_full || is_needed) {
            part += 1;
        }
    }
    of_place
}

impl CellPlane {
    /// The part of a grid's volume that a rectangle of cells has.
    fn volume_of(&self, rectangle: &Rectangle, grid: &Grid) -> Bounds {
        let all = grid.volume();
        let mut part = all;
        for (place, &axis) in self.axes.iter().enumerate() {
            let voxels = u64::from(self.size[axis]);
            let border = |cell: u32| match &self.columns {
                None => (u64::from(cell) * voxels).div_ceil(u64::from(self.cells[place])),
                Some(columns) => columns[place].partition_point(|&at| u32::from(at) < cell) as u64,
            };
            let at = |voxel: u64| all.low[axis] + all.extent()[axis] * voxel as f64 / voxels as f64;
            let (first, end) = (border(rectangle.low[place]), border(rectangle.high[place]));
            part.low[axis] = at(first);
            if end < voxels {
                part.high[axis] = at(end);
            }
        }
        part
    }
}

impl Rectangle {
    /// How many cells it has.
    pub fn cells(&self) -> u64 {
        self.side(0) * self.side(1)
    }

    fn side(&self, axis: usize) -> u64 {
        u64::from(self.high[axis] - self.low[axis])
    }

    fn cut(self, axis: usize, at: u32) -> [Rectangle; 2] {
        let (mut low, mut high) = (self, self);
        (low.high[axis], high.low[axis]) = (at, at);
        [low, high]
    }
}

impl Regions {
    /// Each cell a region of its own.
    pub fn of_cells(plane: CellPlane) -> Regions {
        let [across, down] = plane.cells;
        let cells = (0..down).flat_map(|y| (0..across).map(move |x| [x, y]));
        let rectangles = cells.map(|low| Rectangle { low, high: low.map(|at| at + 1) }).collect();
        Regions::new(plane, rectangles)
    }

    /// One region of all cells.
    pub fn whole(plane: CellPlane) -> Regions {
        let all = Rectangle { low: [0, 0], high: plane.cells };
        Regions::new(plane, vec![all])
    }

    /// So many regions of equal work, of which `work` tells each cell's: the rectangle of cells is cut in two where its work divides
    /// as the numbers of regions on either side do, across its longer side if that can be, and so on with the halves.
    ///
    /// Fails if there are not enough cells.
    pub fn of_equal_work(plane: CellPlane, work: &[u64], regions: usize) -> Result<Regions, TooFewCells> {
        let sums = Sums::new(plane.cells, work);
        let all = Rectangle { low: [0, 0], high: plane.cells };
        let mut rectangles = Vec::with_capacity(regions);
        if !bisect(&sums, all, regions.max(1), &mut rectangles) {
            return Err(TooFewCells { regions, across: plane.cells[0], down: plane.cells[1] });
        }
        Ok(Regions::new(plane, rectangles))
    }

    fn new(plane: CellPlane, rectangles: Vec<Rectangle>) -> Regions {
        let mut of_cell = vec![0; plane.cells.map(|side| side as usize).iter().product()];
        for (region, rectangle) in rectangles.iter().enumerate() {
            for y in rectangle.low[1]..rectangle.high[1] {
                let line = (y * plane.cells[0]) as usize;
                let cells = line + rectangle.low[0] as usize..line + rectangle.high[0] as usize;
                of_cell[cells].fill(region as u16);
            }
        }
        Regions { plane, rectangles, of_cell }
    }

    /// Whether each cell is in the region that it is said to be in, which may not be so of what was read from a file.
    pub fn is_whole(&self) -> bool {
        let [across, down] = self.plane.cells;
        let is_possible = across > 0 && down > 0 && u64::from(across) * u64::from(down) == self.of_cell.len() as u64;
        let is_inside = |rectangle: &Rectangle| {
            let along = |axis: usize| {
                rectangle.low[axis] < rectangle.high[axis] && rectangle.high[axis] <= self.plane.cells[axis]
            };
            along(0) && along(1)
        };
        is_possible
            && self.plane.is_whole()
            && !self.rectangles.is_empty()
            && self.rectangles.iter().all(is_inside)
            && self.of_cell.iter().all(|&region| usize::from(region) < self.rectangles.len())
    }

    /// The plane of cells.
    pub fn plane(&self) -> &CellPlane {
        &self.plane
    }

    /// The regions' rectangles of cells.
    pub fn rectangles(&self) -> &[Rectangle] {
        &self.rectangles
    }

    /// The part of the grid's volume that each has.
    pub fn volumes(&self, grid: &Grid) -> Vec<Bounds> {
        self.rectangles.iter().map(|rectangle| self.plane.volume_of(rectangle, grid)).collect()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.rectangles.len()
    }

    /// Each cell's region; along the first axis cells run fastest.
    pub fn by_cell(&self) -> &[u16] {
        &self.of_cell
    }

    /// The region of a voxel.
    #[inline]
    pub fn of_voxel(&self, voxel: usize) -> u16 {
        self.of_cell[self.plane.cell_of(voxel)]
    }
}

/// The work of all cells to the left of and above a corner.
struct Sums {
    width: usize,
    sums: Vec<u128>,
}

impl Sums {
    fn new([across, down]: [u32; 2], work: &[u64]) -> Sums {
        let width = across as usize + 1;
        let mut sums = vec![0u128; width * (down as usize + 1)];
        for (cell, &amount) in work.iter().enumerate() {
            let place = (cell / (width - 1) + 1) * width + cell % (width - 1) + 1;
            sums[place] = u128::from(amount) + sums[place - 1] + sums[place - width] - sums[place - width - 1];
        }
        Sums { width, sums }
    }

    fn of(&self, Rectangle { low, high }: Rectangle) -> u128 {
        let at = |x: u32, y: u32| self.sums[y as usize * self.width + x as usize];
        at(high[0], high[1]) + at(low[0], low[1]) - at(low[0], high[1]) - at(high[0], low[1])
    }
}

/// Cuts a rectangle into so many. False if it has too few cells.
fn bisect(sums: &Sums, rectangle: Rectangle, regions: usize, into: &mut Vec<Rectangle>) -> bool {
    if regions == 1 {
        into.push(rectangle);
        return true;
    }
    let fewer = regions / 2;
    let longer = usize::from(rectangle.side(1) > rectangle.side(0));
    let best = best_cut(sums, rectangle, longer, (fewer, regions));
    let Some([low, high]) = best.or_else(|| best_cut(sums, rectangle, 1 - longer, (fewer, regions))) else {
        return false;
    };
    bisect(sums, low, fewer, into) && bisect(sums, high, regions - fewer, into)
}

/// The cut across an axis whose two sides' work divides best, of those that leave cells enough on both.
fn best_cut(sums: &Sums, all: Rectangle, axis: usize, (fewer, regions): (usize, usize)) -> Option<[Rectangle; 2]> {
    let total = sums.of(all) * fewer as u128;
    let has_room =
        |[low, high]: &[Rectangle; 2]| low.cells() >= fewer as u64 && high.cells() >= (regions - fewer) as u64;
    let cuts = (all.low[axis] + 1..all.high[axis]).map(|at| all.cut(axis, at)).filter(has_room);
    cuts.min_by_key(|[low, _]| (sums.of(*low) * regions as u128).abs_diff(total))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn regions_are_as_many_as_asked_for_and_have_each_cell_once(
            across in 1u32..20, down in 1u32..20, regions in 1usize..40, seed in any::<u64>(),
        ) {
            let plane = CellPlane { size: [across, down, 1], axes: [0, 1], cells: [across, down], columns: None };
            let work: Vec<u64> = (0..u64::from(across * down)).map(|cell| (cell ^ seed).wrapping_mul(0x9e37_79b9) % 1000).collect();
            match Regions::of_equal_work(plane, &work, regions) {
                Err(_) => prop_assert!(regions > (across * down) as usize / 2, "only near the number of cells"),
                Ok(made) => {
                    prop_assert_eq!(made.count(), regions);
                    let cells: u64 = made.rectangles().iter().map(Rectangle::cells).sum();
                    prop_assert_eq!(cells, u64::from(across * down));
                    for (region, rectangle) in made.rectangles().iter().enumerate() {
                        prop_assert!(rectangle.cells() > 0);
                        prop_assert_eq!(made.by_cell()[(rectangle.low[1] * across + rectangle.low[0]) as usize], region as u16);
                    }
                }
            }
        }
    }

    #[test]
    fn equal_work_on_a_plain_plane_is_equal_cells() {
        let plane = CellPlane { size: [8, 4, 1], axes: [0, 1], cells: [8, 4], columns: None };
        let made = Regions::of_equal_work(plane, &[1; 32], 4).unwrap();
        assert!(made.rectangles().iter().all(|rectangle| rectangle.cells() == 8), "{made:?}");
    }

    #[test]
    fn quantiles_have_equal_work() {
        let plane = CellPlane { size: [8, 4, 1], axes: [0, 1], cells: [8, 4], columns: None };
        // All work is in the first two columns and the first line; the others need a cell each at the most.
        let work: Vec<u64> = (0..32).map(|cell| if cell == 0 || cell == 1 { 100 } else { 0 }).collect();
        let (made, of_these) = plane.quantiles(&work, 3);
        assert_eq!(made.size(), [3, 3]);
        assert_eq!(of_these[..8], [0, 1, 2, 2, 2, 2, 2, 2]);
        assert!(made.is_whole());
        let equal = plane.quantiles(&[1; 32], 4).0;
        assert_eq!(equal.columns, Some([vec![0, 0, 1, 1, 2, 2, 3, 3], vec![0, 1, 2, 3]]));
        assert_eq!(
            (0..32).map(|voxel| equal.cell_of(voxel)).collect::<Vec<_>>(),
            plane.quantiles(&[1; 32], 4).1.iter().map(|&cell| usize::from(cell)).collect::<Vec<_>>()
        );
    }

    proptest! {
        #[test]
        fn equal_parts_leave_none_out(sums in prop::collection::vec(0u128..50, 1..40), parts in 1usize..50) {
            let of_place = equal_parts(&sums, parts);
            prop_assert_eq!(of_place[0], 0);
            prop_assert_eq!(usize::from(*of_place.last().unwrap()) + 1, parts.min(sums.len()));
            prop_assert!(of_place.windows(2).all(|pair| pair[1] - pair[0] <= 1));
        }
    }
}
