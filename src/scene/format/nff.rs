//! Reads Haines's Neutral File Format.

use std::path::Path;

use glam::Vec3;

use super::{Draft, ReadOptions, check_size, read_file};
use crate::error::InputError;
use crate::input::text::{self, Text, Token, amount, nearest, parsed, passed_over};
use crate::scene::camera::CameraFault;
use crate::scene::mesh::{Corner, NO_NORMAL};
use crate::scene::{Camera, Light, Material, tessellate};

/// The words that an entity begins with.
const ENTITIES: [&str; 8] = ["v", "b", "l", "f", "p", "pp", "s", "c"];

/// Reads an NFF file. Spheres, cones and cylinders become polygons.
///
/// Words are read one after the other, whatever the lines: programs that write NFF do not agree on where lines end.
pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Draft, InputError> {
    let source = text::decode(read_file(path)?);
    let text = Text { file: path, text: &source };
    let mut reader = Reader::new(text, options.resolution);
    while let Some(entity) = reader.next() {
        reader.entity(entity)?;
    }
    Ok(reader.finish())
}

struct Reader<'a> {
    text: Text<'a>,
    rest: &'a str,
    resolution: u32,
    draft: Draft,
    /// Whether the last entity was a patch, a polygon with normals: patches in a row are the surface of one object.
    patches: bool,
    /// Colours and numbers of materials that cannot be.
    wrong_amounts: u64,
    /// Lights without a colour of their own: how bright each is depends on how many there are.
    plain_lights: Vec<usize>,
}

impl<'a> Reader<'a> {
    fn new(text: Text<'a>, resolution: u32) -> Self {
        let draft = Draft::new(Vec3::Z);
        Reader { text, rest: text.text, resolution, draft, patches: false, wrong_amounts: 0, plain_lights: Vec::new() }
    }

    fn entity(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let goes_on = self.patches && entity.text == "pp";
        self.patches = entity.text == "pp";
        if !goes_on {
            self.draft.mesh.begin_object();
        }
        match entity.text {
            "v" => self.view(entity),
            "b" => {
                let color = self.color(entity)?;
                self.draft.background = color.unwrap_or(self.draft.background);
                Ok(())
            }
            "l" => self.light(entity),
            "f" => self.fill(entity),
            "p" => self.polygon(entity, false),
            "pp" => self.polygon(entity, true),
            "s" => self.sphere(entity),
            "c" => self.cone(entity),
            _ => Err(self.unknown(entity)),
        }
    }

    fn view(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let (mut from, mut at, mut up, mut angle) = (None, None, None, None);
        while let Some(word) = self.peek() {
            match word.text {
                "from" => from = Some(self.place(word)?),
                "at" => at = Some(self.place(word)?),
                "up" => up = Some(self.place(word)?),
                "angle" => angle = Some(self.field(word)?),
                "hither" | "yon" => drop(self.field(word)?),
                "resolution" => {
                    self.field(word)?;
                    self.coordinate(word)?;
                }
                _ => break,
            }
        }
        let missing = |name| match self.peek() {
            Some(word) if !ENTITIES.contains(&word.text) => self.unknown(word),
            _ => self.text.error_at(entity, format!("view has no `{name}`")),
        };
        let camera = Camera {
            from: from.ok_or_else(|| missing("from"))?,
            at: at.ok_or_else(|| missing("at"))?,
            up: up.ok_or_else(|| missing("up"))?,
            angle: angle.ok_or_else(|| missing("angle"))?,
        };
        camera.check().map_err(|fault: CameraFault| self.text.error_at(entity, fault.message()))?;
        self.draft.camera = Some(camera);
        Ok(())
    }

    /// A word that was only peeked at, and the point behind it.
    fn place(&mut self, word: Token<'a>) -> Result<Vec3, InputError> {
        self.next();
        self.vector(word)
    }

    /// A word that was only peeked at, and the number behind it.
    fn field(&mut self, word: Token<'a>) -> Result<f32, InputError> {
        self.next();
        self.coordinate(word)
    }

    fn light(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let at = self.vector(entity)?;
        let color = if self.number_follows() {
            self.color(entity)?.unwrap_or(Vec3::ONE)
        } else {
            self.plain_lights.push(self.draft.lights.len());
            Vec3::ONE
        };
        self.draft.lights.push(Light::point(at, color));
        Ok(())
    }

    /// A material; some files leave out the last numbers.
    fn fill(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let plain = Material::default();
        let mut material = Material { color: self.color(entity)?.unwrap_or(plain.color), ..plain };
        let fields = [
            &mut material.diffuse,
            &mut material.specular,
            &mut material.shine,
            &mut material.transmittance,
            &mut material.refraction,
        ];
        for field in fields {
            if self.number_follows() {
                *field = self.amount(entity)?.unwrap_or(*field);
            }
        }
        if material.refraction == 0.0 {
            material.refraction = 1.0; // What the standard databases give to opaque things.
        }
        self.draft.materials.push(material);
        Ok(())
    }

    fn polygon(&mut self, entity: Token<'a>, has_normals: bool) -> Result<(), InputError> {
        let token = self.argument(entity)?;
        let count: u64 = token
            .text
            .parse()
            .map_err(|_| self.text.error_at(token, format!("`{}` is not a number of vertices", token.text)))?;
        let mut corners = Vec::new();
        for _ in 0..count {
            let point = self.vector(entity)?;
            let point = self.draft.mesh.add_point(point);
            let normal = if has_normals { self.normal(entity)? } else { NO_NORMAL };
            corners.push(Corner { point, normal });
        }
        if corners.len() < 3 {
            self.draft.pass_over_face();
        } else {
            self.draft.mesh.add_smooth_face(&corners, self.material());
        }
        Ok(())
    }

    fn normal(&mut self, entity: Token<'a>) -> Result<u32, InputError> {
        let numbers = [self.any_number(entity)?, self.any_number(entity)?, self.any_number(entity)?];
        Ok(self.draft.add_normal(numbers))
    }

    fn sphere(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let center = self.vector(entity)?;
        let radius = self.coordinate(entity)?;
        if radius == 0.0 {
            return Err(self.text.error_at(entity, "sphere has a radius of 0"));
        }
        let material = self.material();
        tessellate::sphere(&mut self.draft.mesh, center, radius, self.resolution, material);
        self.check_round(entity)
    }

    fn cone(&mut self, entity: Token<'a>) -> Result<(), InputError> {
        let base = self.vector(entity)?;
        let base_radius = self.coordinate(entity)?;
        let apex = self.vector(entity)?;
        let apex_radius = self.coordinate(entity)?;
        if let Some(fault) = cone_fault(base == apex, base_radius, apex_radius) {
            return Err(self.text.error_at(entity, fault));
        }
        let material = self.material();
        let mesh = &mut self.draft.mesh;
        tessellate::cone(mesh, base, base_radius, apex, apex_radius, self.resolution, material);
        self.check_round(entity)
    }

    /// Checks what a sphere or cone added, which are the only entities larger than their text.
    fn check_round(&self, entity: Token) -> Result<(), InputError> {
        check_size(&self.draft.mesh, 0).map_err(|message| self.text.error_at(entity, message))
    }

    /// The number of the last fill, or of the default material before the first.
    fn material(&self) -> u32 {
        self.draft.materials.len() as u32 - 1
    }

    fn finish(mut self) -> Draft {
        // The format's rule for lights without a colour.
        let brightness = 1.0 / (self.draft.lights.len().max(1) as f32).sqrt();
        for i in self.plain_lights {
            self.draft.lights[i].color = Vec3::splat(brightness);
        }
        let (one, many) = ("colour or number of a material", "colours or numbers of materials");
        let note = passed_over(self.wrong_amounts, one, many);
        self.draft.notes.extend(note.map(|note| format!("{note}: out of range")));
        self.draft
    }

    fn vector(&mut self, entity: Token<'a>) -> Result<Vec3, InputError> {
        let tokens = [self.argument(entity)?, self.argument(entity)?, self.argument(entity)?];
        self.text.vector(tokens)
    }

    /// The next three numbers, if they can be a colour.
    fn color(&mut self, entity: Token<'a>) -> Result<Option<Vec3>, InputError> {
        let numbers = [self.any_number(entity)?, self.any_number(entity)?, self.any_number(entity)?];
        let [r, g, b] = numbers.map(|number| amount(number).ok());
        let color = r.zip(g).zip(b).map(|((r, g), b)| Vec3::new(r, g, b));
        self.wrong_amounts += u64::from(color.is_none());
        Ok(color)
    }

    /// The next number, if it can be a coefficient.
    fn amount(&mut self, entity: Token<'a>) -> Result<Option<f32>, InputError> {
        let amount = amount(self.any_number(entity)?).ok();
        self.wrong_amounts += u64::from(amount.is_none());
        Ok(amount)
    }

    fn any_number(&mut self, entity: Token<'a>) -> Result<f64, InputError> {
        let token = self.argument(entity)?;
        self.text.any_number(token)
    }

    fn coordinate(&mut self, entity: Token<'a>) -> Result<f32, InputError> {
        let token = self.argument(entity)?;
        self.text.coordinate(token)
    }

    /// The next word, which belongs to an entity.
    fn argument(&mut self, entity: Token<'a>) -> Result<Token<'a>, InputError> {
        let missing = || self.text.error(self.text.end(), format!("file ends in the middle of `{}`", entity.text));
        let token = self.peek().ok_or_else(missing)?;
        self.next();
        Ok(token)
    }

    fn number_follows(&self) -> bool {
        self.peek().is_some_and(|token| parsed(token.text).is_some())
    }

    fn next(&mut self) -> Option<Token<'a>> {
        let token = self.peek()?;
        self.rest = &self.text.text[token.span().end..];
        Some(token)
    }

    fn peek(&self) -> Option<Token<'a>> {
        let mut rest = self.rest.trim_ascii_start();
        while rest.starts_with('#') {
            rest = rest.split_once('\n').map_or("", |(_, rest)| rest).trim_ascii_start();
        }
        let end = rest.find(|c: char| c.is_ascii_whitespace() || c == '#').unwrap_or(rest.len());
        let text = &rest[..end];
        (!text.is_empty()).then(|| Token { text, at: self.text.offset_of(text) })
    }

    fn unknown(&self, entity: Token) -> InputError {
        let error = self.text.error_at(entity, format!("`{}` is no NFF entity", entity.text));
        if entity.text.eq_ignore_ascii_case("nff") {
            return error.help("this may be the format of WorldToolKit, which has the same name");
        }
        match nearest(entity.text, ["from", "at", "up", "angle", "hither", "resolution"]) {
            Some(name) => error.help(format!("did you mean `{name}`, a part of the view?")),
            None => error.help(format!("known are {}", ENTITIES.join(", "))),
        }
    }
}

fn cone_fault(coincident: bool, base_radius: f32, apex_radius: f32) -> Option<&'static str> {
    let (least, most) = (base_radius.min(apex_radius), base_radius.max(apex_radius));
    if coincident {
        Some("base and apex of the cone are the same point")
    } else if least == 0.0 && most == 0.0 {
        Some("both radii of the cone are 0")
    } else if least < 0.0 && most > 0.0 {
        Some("one radius of the cone is negative and the other is not")
    } else {
        None
    }
}
