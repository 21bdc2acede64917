//! Pictures of few colours: the octree in Peano's order, and median cut beside it.

use std::collections::BTreeSet;

use pcs_sim::host::color_table::{Color, ColorTable, Palette, key};
use proptest::prelude::*;

use crate::support::command::Folder;
use crate::support::pictures::decoded;

#[test]
fn keys_are_in_peanos_order() {
    // The thesis's example in the plane, i = 7 and j = 3 give 47: here between them bits of a third part, which is 0.
    let spread = key([7, 3, 0]);
    let plane = (0..3).fold(0, |plane, bit| plane | (spread >> (3 * bit + 1) & 3) << (2 * bit));
    assert_eq!(plane, 47);
    assert_eq!((key([0, 0, 0]), key([255, 255, 255]), key([128, 0, 0])), (0, (1 << 24) - 1, 1 << 23));
}

/// The corners of a cube of side 1, of which one has 1 pixel, the next 2, and so on, in three colours.
#[test]
fn a_cube_by_hand() {
    let corner = |number: u32| [number >> 2 & 1, number >> 1 & 1, number & 1].map(|part| 10 + part as u8);
    let pixels: Vec<Color> = (0..8).flat_map(|number| vec![corner(number); number as usize + 1]).collect();
    let table = ColorTable::new(&pixels, 3, Palette::Peano);
    // The two most frequent have entries of their own. Of the others' 21 pixels 11 have the higher red, 7 green, 12 blue.
    assert_eq!(table.level, Some(0));
    assert_eq!(
        table.colors.iter().copied().collect::<BTreeSet<_>>(),
        [[11, 11, 11], [11, 11, 10], [11, 10, 11]].into_iter().collect()
    );
    let of = |number: u32| {
        table.colors[usize::from(table.pixels[pixels.iter().position(|&it| it == corner(number)).unwrap()])]
    };
    assert_eq!((of(7), of(6)), ([11, 11, 11], [11, 11, 10]));
    assert!((0..6).all(|number| of(number) == [11, 10, 11]));
}

/// The same colours by the other ways. The fixed table of 3 has one bit, that of red: all are 0. The most frequent cube is the only one.
#[test]
fn other_tables_by_hand() {
    let pixels: Vec<Color> = [([200, 0, 0], 5), ([8, 8, 8], 3), ([9, 9, 9], 1), ([0, 250, 0], 2)]
        .into_iter()
        .flat_map(|(color, count)| vec![color; count])
        .collect();
    let shown = |most: usize, palette: Palette| {
        let table = ColorTable::new(&pixels, most, palette);
        [0, 5, 8, 9].map(|at| table.colors[usize::from(table.pixels[at])])
    };
    assert_eq!(shown(4, Palette::Fixed), [[200, 0, 0], [8, 8, 8], [9, 9, 9], [0, 250, 0]], "no more than 4");
    // Two bits are red's and green's first.
    assert_eq!(shown(3, Palette::Fixed), [[128, 0, 0], [0; 3], [0; 3], [0; 3]]);
    let red = [128, 0, 0];
    assert_eq!(ColorTable::new(&pixels, 3, Palette::Fixed).colors, [[0; 3], red]);
    // The two darks are in one cube of side 8, whose mean is nearer to [8, 8, 8]; of two entries the green goes to the darks.
    assert_eq!(shown(3, Palette::Popularity), [[200, 0, 0], [8, 8, 8], [8, 8, 8], [0, 250, 0]]);
    assert_eq!(shown(2, Palette::Popularity), [[200, 0, 0], [8, 8, 8], [8, 8, 8], [8, 8, 8]]);
    assert_eq!(shown(3, Palette::Gervautz), [[200, 0, 0], [8, 8, 8], [8, 8, 8], [0, 250, 0]]);
    // 8 and 9 differ in their lowest bits: they share a cube of side 2, and the brightest about its middle is [9, 9, 9].
    assert_eq!(shown(3, Palette::PeanoLarge)[1], [9, 9, 9]);
}

/// What the thesis says of a picture as it is: the octree in Peano's order has a smaller mean error than its larger cousin, than colours
/// given beforehand, and than those that occur most.
#[test]
fn the_octree_is_better_than_fixed_and_most_frequent_colours() {
    let pixels: Vec<Color> = (0..64u32)
        .flat_map(|line| {
            (0..64u32).map(move |column| [(2 * line + column) as u8, (3 * column) as u8, (line * column / 20) as u8])
        })
        .collect();
    let error = |palette| ColorTable::new(&pixels, 64, palette).error(&pixels).mean_square;
    let [peano, large, fixed, popular] =
        [Palette::Peano, Palette::PeanoLarge, Palette::Fixed, Palette::Popularity].map(error);
    assert!(peano < large && large < fixed && peano < popular, "{peano} {large} {fixed} {popular}");
}

fn picture() -> impl Strategy<Value = Vec<Color>> {
    let near = (0u8..40, 0u8..40, 100u8..180).prop_map(|(r, v, b)| [r, v, b]);
    prop::collection::vec(prop_oneof![near, any::<[u8; 3]>()], 1..400)
}

proptest! {
    #[test]
    fn tables_keep_their_promises(pixels in picture(), most in 1usize..=64) {
        let distinct = pixels.iter().collect::<BTreeSet<_>>().len();
        for palette in Palette::ALL {
            let table = ColorTable::new(&pixels, most, palette);
            prop_assert!(table.colors.len() <= most && table.pixels.len() == pixels.len());
            let error = table.error(&pixels);
            if distinct <= most {
                prop_assert_eq!(error.largest, 0.0);
            }
            if let Some(bound) = table.bound() {
                prop_assert!(error.largest <= bound, "{:?} {}", error, bound);
            }
            prop_assert!(error.mean_square <= error.largest * error.largest + 1e-9);
            let mut backwards = pixels.clone();
            backwards.reverse();
            let other = ColorTable::new(&backwards, most, palette);
            prop_assert_eq!(&other.colors, &table.colors);
            prop_assert!(other.pixels.iter().rev().eq(&table.pixels));
        }
    }
}

#[test]
fn images_have_as_many_colours_as_asked_for() {
    let folder = Folder::new();
    let mut said = String::new();
    for palette in ["peano", "peano-large", "fixed", "popularity", "median-cut", "gervautz"] {
        let name = format!("{palette}.png");
        let text = folder
            .run(&format!("image room --size 48x32 --timing off --colors 24 --palette {palette} -o {name}"))
            .success();
        let told = text.lines().skip_while(|line| !line.contains(" colours by ")).take_while(|line| !line.is_empty());
        said += &told.collect::<Vec<_>>().join(" ");
        said += "\n";
        let info = decoded(&folder.path(&name)).info;
        assert_eq!(info.color_type, png::ColorType::Indexed);
        let colors = info.palette.as_ref().unwrap().len() / 3;
        // Of those that are given beforehand, as many as the picture has a use for.
        assert_eq!(colors, if palette == "fixed" { 7 } else { 24 }, "{palette}");
    }
    insta::assert_snapshot!(said);
    // More than a PNG's table can have are written one by one.
    folder
        .run("image room --size 48x32 --timing off --samples 3 --colors 300 --palette peano-large -o many.png")
        .success();
    let many = decoded(&folder.path("many.png"));
    assert_eq!(many.info.color_type, png::ColorType::Rgb);
    let colors = many.bytes.chunks_exact(3).collect::<BTreeSet<_>>().len();
    assert!(colors > 100 && colors <= 300, "{colors}");
    for flags in [
        "--colors 24 -o a.pfm",
        "--colors 0 -o a.png",
        "--colors 65537 -o a.png",
        "--colors 8 --palette oil -o a.png",
        "--palette peano -o a.png",
    ] {
        assert_eq!(folder.run(&format!("image room --size 8x8 --timing off {flags}")).status, 2, "{flags}");
    }
}
