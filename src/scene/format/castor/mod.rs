//! Reads files of Castor, SKY's scene language (Argence's thesis, chapter 5, section 1.1), as far as its shapes are ours.
//!
//! ```text
//! top = @a(7,5,0.5) !cu(180,90,80,0);
//! leg = @a(0.1,0.1,3.5) @t(0,0,-1) !cu(180,90,80,0);
//! all = $U(top, leg, @t(7,0,0) leg);
//! > all;
//! ```
//!
//! Maps apply from the right, the one next to a shape first. The scan of the thesis leaves signs in doubt: that of transparency is
//! read as a double quote. Colours, from 0 to 255, are taken as those of a screen (sRGB).

mod source;

use std::collections::HashMap;
use std::path::Path;

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

use self::source::{Source, Token};
use super::{Draft, ReadOptions, check_size, vertex_color};
use crate::error::InputError;
use crate::input::text::{coordinate, nearest, plural};
use crate::scene::Material;
use crate::scene::solid::{Options, Shell, Solid, evaluate};

/// How thick the flat shapes `sq`, `ci` and `po` are in their own frame: the thesis, too, takes them for thin solids.
const THICKNESS: f64 = 1e-4;

/// Most polygons of all shapes that all names stand for, and of those of one object: names are copied where they are used, and their
/// copies copied.
const MOST_POLYGONS: usize = 4_000_000;

/// How deep operations and maps may stand in each other, those of names among them.
const DEEPEST: usize = 200;

/// The shapes: what they are called, and whether they are ours.
const SHAPES: [(&str, bool); 11] = [
    ("cu", true),
    ("sp", true),
    ("co", true),
    ("cy", true),
    ("pr", true),
    ("sq", true),
    ("ci", true),
    ("po", true),
    ("hp", false),
    ("tr", false),
    ("ld", false),
];

/// Reads a Castor file, and those that it includes from its folder.
pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Draft, InputError> {
    let tokens = source::read(path)?;
    let draft = Draft::new(Vec3::Z);
    let mut parser =
        Parser { tokens: &tokens, at: 0, names: HashMap::new(), draft, options, polygons: 0, textures: 0, shown: 0 };
    parser.draft.materials.clear();
    parser.file()?;
    parser.finish(path)
}

struct Parser<'a> {
    tokens: &'a Source,
    at: usize,
    names: HashMap<String, Object>,
    draft: Draft,
    options: &'a ReadOptions,
    /// Of all names' shapes.
    polygons: usize,
    textures: u32,
    shown: u32,
}

/// What a name stands for.
#[derive(Clone)]
struct Object {
    solid: Solid,
    /// Those of its shapes.
    polygons: usize,
    /// How deep its tree of operations and maps is.
    depth: usize,
}

impl Parser<'_> {
    fn file(&mut self) -> Result<(), InputError> {
        while let Some(token) = self.next() {
            if token.text == ">" {
                let name = self.name()?;
                let object = self.named(&name)?;
                self.show(&name, &object.solid)?;
            } else if token.is_name() {
                self.expect("=")?;
                let object = self.expression(0)?;
                self.set(&token, object)?;
            } else {
                return Err(self
                    .tokens
                    .error(&token, format!("`{}` begins nothing: a name or `>` was expected", token.text)));
            }
            self.expect(";")?;
        }
        Ok(())
    }

    fn set(&mut self, name: &Token, object: Object) -> Result<(), InputError> {
        self.polygons += object.polygons;
        let before = self.names.insert(name.text.clone(), object);
        self.polygons -= before.map_or(0, |before| before.polygons);
        self.check_polygons(name, self.polygons)
    }

    fn check_polygons(&self, place: &Token, count: usize) -> Result<(), InputError> {
        if count > MOST_POLYGONS {
            return Err(self.tokens.error(place, format!("objects have more than {MOST_POLYGONS} polygons so far")));
        }
        Ok(())
    }

    fn check_depth(&self, place: &Token, depth: usize) -> Result<(), InputError> {
        if depth > DEEPEST {
            let message = format!("more than {DEEPEST} operations and maps stand in each other");
            return Err(self.tokens.error(place, message));
        }
        Ok(())
    }

    fn finish(mut self, path: &Path) -> Result<Draft, InputError> {
        if self.shown == 0 {
            let error = InputError::in_file(path, "the file shows nothing");
            return Err(error.help("write `> NAME;` for what is to be seen"));
        }
        if self.textures > 0 {
            let textures = plural(self.textures.into(), "texture");
            self.draft.notes.push(format!("{textures} left out: surfaces have one colour here"));
        }
        if self.draft.materials.is_empty() {
            self.draft.materials.push(Material::default());
        }
        Ok(self.draft)
    }

    fn show(&mut self, name: &Token, solid: &Solid) -> Result<(), InputError> {
        let evaluated = evaluate(solid, Options::default()).map_err(|message| self.tokens.error(name, message))?;
        check_size(&self.draft.mesh, evaluated.mesh.corner_count())
            .map_err(|message| self.tokens.error(name, message))?;
        self.draft.notes.push(format!("solid `{}`: {}", name.text, evaluated.report.sentence()));
        self.draft.solids.push(evaluated.report);
        self.draft.mesh.append(evaluated.mesh, |own| own);
        self.shown += 1;
        Ok(())
    }

    /// `{ map } atom`
    fn expression(&mut self, depth: usize) -> Result<Object, InputError> {
        let mut map = DAffine3::IDENTITY;
        let mut glass = None;
        loop {
            let token = self.any("an object")?;
            match token.text.as_str() {
                "@" => map *= self.map()?,
                "-" | "?" => self.texture()?,
                "\"" => glass = glass.or(Some(self.glass()?)),
                _ => {
                    let mut object = self.atom(&token, depth)?;
                    if let Some(glass) = glass {
                        object.solid.change_materials(&mut |material| self.of_glass(material, glass));
                    }
                    if map != DAffine3::IDENTITY {
                        object.solid = object.solid.placed(map);
                        object.depth += 1;
                        self.check_depth(&token, object.depth)?;
                    }
                    return Ok(object);
                }
            }
        }
    }

    fn atom(&mut self, token: &Token, depth: usize) -> Result<Object, InputError> {
        match token.text.as_str() {
            "!" => self.shape(),
            "$" => self.operation(depth + 1),
            _ if token.is_name() => self.named(token),
            _ => {
                Err(self.tokens.error(token, format!("`{}` is no object: a name, `!` or `$` was expected", token.text)))
            }
        }
    }

    /// The object that a name stands for so far.
    fn named(&self, name: &Token) -> Result<Object, InputError> {
        self.names.get(&name.text).cloned().ok_or_else(|| {
            let error = self.tokens.error(name, format!("`{}` is used before it is set", name.text));
            match nearest(&name.text, self.names.keys().map(String::as_str)) {
                Some(close) => error.help(format!("did you mean `{close}`?")),
                None => error,
            }
        })
    }

    /// `U`, `I` or `D` and its operands in parentheses, behind the last of which a comma may stand.
    fn operation(&mut self, depth: usize) -> Result<Object, InputError> {
        let name = self.name()?;
        self.check_depth(&name, depth)?;
        let make = match name.text.as_str() {
            "U" => Solid::Union,
            "I" => Solid::Intersection,
            "D" => Solid::Difference,
            other => {
                return Err(self
                    .tokens
                    .error(&name, format!("there is no operation `{other}`"))
                    .help("there are U, I and D"));
            }
        };
        self.expect("(")?;
        let (mut operands, mut polygons, mut deepest) = (Vec::new(), 0, 0);
        loop {
            let operand = self.expression(depth)?;
            polygons += operand.polygons;
            deepest = deepest.max(operand.depth);
            self.check_polygons(&name, polygons)?;
            self.check_depth(&name, deepest + 1)?;
            operands.push(operand.solid);
            let comma = self.take(",");
            if self.take(")") {
                return Ok(Object { solid: make(operands), polygons, depth: deepest + 1 });
            }
            if !comma {
                let token = self.any("`,` or `)`")?;
                return Err(self.tokens.error(&token, format!("`,` or `)` was expected, not `{}`", token.text)));
            }
        }
    }

    /// A shape's name and numbers.
    fn shape(&mut self) -> Result<Object, InputError> {
        let name = self.name()?;
        let known = SHAPES.iter().find(|(known, _)| *known == name.text);
        let Some(&(kind, ours)) = known else {
            let names: Vec<&str> = SHAPES.iter().map(|(name, _)| *name).collect();
            let error = self.tokens.error(&name, format!("there is no shape `{}`", name.text));
            return Err(error.help(format!("there are {}", names.join(", "))));
        };
        if !ours {
            let error = self.tokens.error(&name, format!("shape `{kind}` is not read"));
            return Err(error.help("hyperboloids, foliage and terrain are not among the shapes that can be evaluated"));
        }
        let numbers = self.numbers()?;
        let polygon = ["pr", "po"].contains(&kind);
        let fixed = numbers.len() == 4 || (polygon && numbers.len() > 4);
        if !fixed || (polygon && !numbers.len().is_multiple_of(2)) {
            let expected = if polygon {
                "x and y of each corner, then 3 of colour and a specularity"
            } else {
                "3 of colour and a specularity"
            };
            return Err(self
                .tokens
                .error(&name, format!("`{kind}` has {} numbers, it takes {expected}", numbers.len())));
        }
        let (corners, color) = numbers.split_at(numbers.len() - 4);
        let corners: Vec<DVec2> = corners.chunks_exact(2).map(DVec2::from_slice).collect();
        let slices = self.options.resolution;
        let shell = match kind {
            "cu" | "sq" => Shell::cube(),
            "sp" => Shell::sphere(slices),
            "co" => Shell::cone(slices),
            "cy" | "ci" => Shell::cylinder(slices),
            _ => Shell::prism(&corners).map_err(|message| self.tokens.error(&name, message))?,
        };
        let material = self.colored(&name, [color[0], color[1], color[2], color[3]])?;
        let polygons = shell.face_count();
        let solid = Solid::leaf(shell.of_material(material));
        let is_flat = ["sq", "ci", "po"].contains(&kind);
        let thin = DAffine3::from_scale(DVec3::new(1.0, 1.0, THICKNESS));
        Ok(Object { solid: if is_flat { solid.placed(thin) } else { solid }, polygons, depth: 1 })
    }

    fn colored(&mut self, place: &Token, [red, green, blue, specular]: [f64; 4]) -> Result<u32, InputError> {
        if let Some(wrong) = [red, green, blue].iter().find(|part| !(0.0..=255.0).contains(*part)) {
            return Err(self.tokens.error(place, format!("colour {wrong} is not from 0 to 255")));
        }
        self.share(place, specular)?;
        let color = Vec3::from([red, green, blue].map(|part| vertex_color::light(part as f32 / 255.0)));
        Ok(self.material(Material { color, specular: specular as f32, ..Material::default() }))
    }

    fn share(&self, place: &Token, number: f64) -> Result<(), InputError> {
        if (0.0..=1.0).contains(&number) {
            Ok(())
        } else {
            Err(self.tokens.error(place, format!("{number} is not from 0 to 1")))
        }
    }

    /// The number of a material, which is there once.
    fn material(&mut self, material: Material) -> u32 {
        let materials = &mut self.draft.materials;
        let there = materials.iter().position(|other| *other == material);
        there.unwrap_or_else(|| {
            materials.push(material);
            materials.len() - 1
        }) as u32
    }

    fn of_glass(&mut self, material: u32, [index, through, mirrored]: [f64; 3]) -> u32 {
        let own = self.draft.materials[material as usize];
        let changed =
            Material { refraction: index as f32, transmittance: through as f32, specular: mirrored as f32, ..own };
        self.material(changed)
    }

    /// `as` and index of refraction, share of light that passes through, and share that is mirrored.
    fn glass(&mut self) -> Result<[f64; 3], InputError> {
        let name = self.name()?;
        if name.text != "as" {
            return Err(self.tokens.error(&name, format!("`as` was expected behind the quote, not `{}`", name.text)));
        }
        let [index, through, mirrored] = self.exactly(&name)?;
        if index <= 0.0 {
            return Err(self.tokens.error(&name, format!("index of refraction {index} is not above 0")));
        }
        self.share(&name, through)?;
        self.share(&name, mirrored)?;
        Ok([index, through, mirrored])
    }

    /// What is about textures, which are passed over.
    fn texture(&mut self) -> Result<(), InputError> {
        self.name()?;
        self.numbers()?;
        self.textures += 1;
        Ok(())
    }

    fn map(&mut self) -> Result<DAffine3, InputError> {
        let name = self.name()?;
        match name.text.as_str() {
            "t" => Ok(DAffine3::from_translation(DVec3::from(self.exactly(&name)?))),
            "a" => self.scale(&name).map(DAffine3::from_scale),
            "h" => {
                let [by] = self.exactly(&name)?;
                self.nonzero(&name, DVec3::splat(by)).map(DAffine3::from_scale)
            }
            "r" => {
                let [x, y, z, degrees] = self.exactly(&name)?;
                let axis = self.direction(&name, DVec3::new(x, y, z))?;
                Ok(DAffine3::from_axis_angle(axis, degrees.to_radians()))
            }
            "s" => {
                let normal = DVec3::from(self.exactly(&name)?);
                let normal = self.direction(&name, normal)?;
                let outer = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
                Ok(DAffine3::from_mat3(DMat3::IDENTITY - outer * 2.0))
            }
            other => {
                Err(self.tokens.error(&name, format!("there is no map `{other}`")).help("there are r, a, h, s and t"))
            }
        }
    }

    fn scale(&mut self, name: &Token) -> Result<DVec3, InputError> {
        let by = DVec3::from(self.exactly(name)?);
        self.nonzero(name, by)
    }

    fn nonzero(&self, name: &Token, by: DVec3) -> Result<DVec3, InputError> {
        if by.abs().min_element() > 0.0 {
            Ok(by)
        } else {
            Err(self.tokens.error(name, "scale factor is 0, nothing would be left to see"))
        }
    }

    fn direction(&self, name: &Token, way: DVec3) -> Result<DVec3, InputError> {
        way.try_normalize().ok_or_else(|| self.tokens.error(name, "direction is zero"))
    }

    fn exactly<const N: usize>(&mut self, name: &Token) -> Result<[f64; N], InputError> {
        let numbers = self.numbers()?;
        let count = numbers.len();
        <[f64; N]>::try_from(numbers).map_err(|_| {
            self.tokens.error(name, format!("`{}` has {}, it takes {N}", name.text, plural(count as u64, "number")))
        })
    }

    /// Numbers in parentheses.
    fn numbers(&mut self) -> Result<Vec<f64>, InputError> {
        self.expect("(")?;
        let mut numbers = Vec::new();
        loop {
            let mut token = self.any("a number")?;
            let sign = if token.text == "-" { -1.0 } else { 1.0 };
            if token.text == "-" {
                token = self.any("a number")?;
            }
            let number: f64 = token
                .text
                .parse()
                .map_err(|_| self.tokens.error(&token, format!("`{}` is not a number", token.text)))?;
            coordinate(number).map_err(|message| self.tokens.error(&token, message))?;
            numbers.push(sign * number);
            if self.take(")") {
                return Ok(numbers);
            }
            self.expect(",")?;
        }
    }

    fn next(&mut self) -> Option<Token> {
        let token = self.tokens.get(self.at)?.clone();
        self.at += 1;
        Some(token)
    }

    fn any(&mut self, expected: &str) -> Result<Token, InputError> {
        self.next().ok_or_else(|| self.tokens.ended(format!("file ends where {expected} was expected")))
    }

    fn name(&mut self) -> Result<Token, InputError> {
        let token = self.any("a name")?;
        if token.is_name() {
            Ok(token)
        } else {
            Err(self.tokens.error(&token, format!("a name was expected, not `{}`", token.text)))
        }
    }

    fn take(&mut self, sign: &str) -> bool {
        let taken = self.tokens.get(self.at).is_some_and(|token| token.text == sign);
        self.at += usize::from(taken);
        taken
    }

    fn expect(&mut self, sign: &str) -> Result<(), InputError> {
        let token = self.any(&format!("`{sign}`"))?;
        if token.text == sign {
            Ok(())
        } else {
            Err(self.tokens.error(&token, format!("`{sign}` was expected, not `{}`", token.text)))
        }
    }
}
