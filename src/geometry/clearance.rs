//! How far each voxel of a grid is from the next one that holds a polygon.

/// For each voxel the Chebyshev distance to the nearest voxel that holds a polygon, in voxels: 0 if it holds one itself. All
/// voxels nearer than that are empty. At most 255, also where there is none.
///
/// A byte a voxel: it stays in the cache where the voxel table does not.
#[derive(Clone, Debug)]
pub struct Clearance(Vec<u8>);

impl Clearance {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        self.0.len() as u64
    }

    /// Of a grid of `size` voxels, with x running fastest, those of which are occupied whose list in the voxel table is not empty.
    pub fn new(size: [u32; 3], table: &[u32]) -> Clearance {
        let mut voxels: Vec<u8> = table.windows(2).map(|ends| if ends[0] < ends[1] { 0 } else { u8::MAX }).collect();
        let [width, height, depth] = size.map(|n| n as usize);
        let mut nearest = vec![u8::MAX; width + 2];
        // What is nearest comes from one of 26 neighbours: from 13 of them on the way forth, and from the others on the way back.
        for row in 0..height * depth {
            let (y, z) = (row % height, row / height);
            let earlier =
                [(y > 0, 1), (z > 0 && y > 0, height + 1), (z > 0, height), (z > 0 && y + 1 < height, height - 1)];
            let (before, here) = voxels.split_at_mut(row * width);
            gather(
                &mut nearest,
                earlier.map(|(is_there, back)| is_there.then(|| &before[(row - back) * width..][..width])),
            );
            let mut last = u8::MAX;
            for (voxel, neighbours) in here[..width].iter_mut().zip(nearest.windows(3)) {
                last = farther(last, voxel, neighbours);
            }
        }
        for row in (0..height * depth).rev() {
            let (y, z) = (row % height, row / height);
            let is_back = z + 1 < depth;
            let later = [
                (y + 1 < height, 1),
                (is_back && y + 1 < height, height + 1),
                (is_back, height),
                (is_back && y > 0, height - 1),
            ];
            let (here, after) = voxels.split_at_mut((row + 1) * width);
            gather(
                &mut nearest,
                later.map(|(is_there, ahead)| is_there.then(|| &after[(ahead - 1) * width..][..width])),
            );
            let mut last = u8::MAX;
            for (voxel, neighbours) in here[row * width..].iter_mut().zip(nearest.windows(3)).rev() {
                last = farther(last, voxel, neighbours);
            }
        }
        Clearance(voxels)
    }

    /// That of a voxel.
    #[inline]
    pub fn of(&self, voxel: usize) -> u8 {
        self.0[voxel]
    }
}

/// The least of some rows, voxel by voxel, with a voxel of nothing before and behind it.
fn gather(nearest: &mut [u8], rows: [Option<&[u8]>; 4]) {
    let inner = 1..nearest.len() - 1;
    let nearest = &mut nearest[inner];
    nearest.fill(u8::MAX);
    for row in rows.into_iter().flatten() {
        nearest.iter_mut().zip(row).for_each(|(least, &voxel)| *least = voxel.min(*least));
    }
}

/// Lets a voxel be at most one farther than the last one of its row and three neighbours in other rows; gives what it is.
#[inline]
fn farther(last: u8, voxel: &mut u8, neighbours: &[u8]) -> u8 {
    let nearest = neighbours.iter().fold(u8::MAX, |least, &neighbour| least.min(neighbour));
    *voxel = (*voxel).min(nearest.min(last).saturating_add(1));
    *voxel
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_distance_to_the_nearest_occupied_voxel(
            size in [1u32..7, 1u32..7, 1u32..40],
            seeds in prop::collection::vec(0u32..10_000, 0..6),
        ) {
            let count = size.iter().product::<u32>();
            let occupied: Vec<u32> = seeds.iter().map(|seed| seed % count).collect();
            let mut table = vec![0u32];
            for voxel in 0..count {
                table.push(table[voxel as usize] + u32::from(occupied.contains(&voxel)));
            }
            let place = |voxel: u32| [voxel % size[0], voxel / size[0] % size[1], voxel / size[0] / size[1]];
            let apart = |a: u32, b: u32| (0..3).map(|axis| place(a)[axis].abs_diff(place(b)[axis])).max().unwrap_or(0);
            let clearance = Clearance::new(size, &table);
            for voxel in 0..count {
                let nearest = occupied.iter().map(|&other| apart(voxel, other)).min().unwrap_or(255);
                prop_assert_eq!(u32::from(clearance.of(voxel as usize)), nearest);
            }
        }
    }
}
