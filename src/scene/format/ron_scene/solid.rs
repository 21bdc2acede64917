//! Solids in scene files: `Csg(Difference([Cube(), ...]))`.

use glam::{DVec2, DVec3};
use serde::Deserialize;

use super::{MeshText, Reader, ShapeText, StepText, Triple};
use crate::error::InputError;
use crate::input::ron_text::Located;
use crate::input::text::{coordinate, plural};
use crate::scene::ReadOptions;
use crate::scene::format::check_size;
use crate::scene::format::transform::Step;
use crate::scene::solid::{Options, Shell, Solid, evaluate};

/// A solid within a solid.
pub(super) type Node<'a> = Located<'a, SolidText<'a>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Solid", bound(deserialize = "'de: 'a"))]
pub(super) enum SolidText<'a> {
    Union(Vec<Node<'a>>),
    Intersection(Vec<Node<'a>>),
    Difference(Vec<Node<'a>>),
    Place(Vec<Located<'a, StepText>>, Node<'a>),
    Hollow {
        solid: Node<'a>,
        keep: Triple<'a>,
    },
    Cube {
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Sphere {
        slices: Option<Located<'a, u32>>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Cone {
        slices: Option<Located<'a, u32>>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Cylinder {
        slices: Option<Located<'a, u32>>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Torus {
        r: Located<'a, f64>,
        slices: Option<Located<'a, u32>>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Prism {
        points: Vec<Located<'a, (f64, f64)>>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
    Solid {
        shape: ShapeText<'a>,
        material: Option<Located<'a, String>>,
        priority: Option<i32>,
    },
}

impl Reader<'_> {
    /// Adds a solid of the file to the scene.
    pub(super) fn csg(&mut self, text: &MeshText, solid: &Node) -> Result<(), InputError> {
        let material = text.material.as_ref().map(|name| self.material_number(name)).transpose()?;
        let steps: Vec<Step> = text.transform.iter().map(|step| self.step(step)).collect::<Result<_, _>>()?;
        let solid_read = self.solid(solid, material)?.placed(Step::map_of(&steps));
        let cut = text.cut.as_ref().map(|cut| cut.read(self.text)).transpose()?;
        let join = text.join.as_ref().map(|join| join.read(self.text)).transpose()?;
        let options = Options { cut: cut.unwrap_or_default(), join: join.unwrap_or(true) };
        let evaluated = evaluate(&solid_read, options).map_err(|message| solid.error(self.text, message))?;
        if let Some(most) = &text.max_polygons {
            let (count, allowed) = (evaluated.report.polygons, most.read(self.text)?);
            if count > allowed {
                let message = format!("the solid has {}, more than the {allowed} allowed", plural(count, "polygon"));
                return Err(most.error(self.text, message).help("allow more, or take fewer slices"));
            }
        }
        if evaluated.report.polygons == 0 {
            self.draft
                .notes
                .push(format!("nothing is left of a solid of {}", plural(evaluated.report.primitives, "primitive")));
        } else {
            self.draft.notes.push(format!("solid: {}", evaluated.report.sentence()));
        }
        self.draft.solids.push(evaluated.report);
        let corners = evaluated.mesh.corner_count();
        check_size(&self.draft.mesh, corners).map_err(|message| solid.error(self.text, message))?;
        self.draft.mesh.append(evaluated.mesh, |own| own);
        Ok(())
    }

    fn solid(&mut self, node: &Node, material: Option<u32>) -> Result<Solid, InputError> {
        match node.nested(self.text)? {
            SolidText::Union(nodes) => Ok(Solid::Union(self.operands(node, &nodes, material)?)),
            SolidText::Intersection(nodes) => Ok(Solid::Intersection(self.operands(node, &nodes, material)?)),
            SolidText::Difference(nodes) => Ok(Solid::Difference(self.operands(node, &nodes, material)?)),
            SolidText::Place(steps, inner) => {
                let steps: Vec<Step> = steps.iter().map(|step| self.step(step)).collect::<Result<_, _>>()?;
                Ok(self.solid(&inner, material)?.placed(Step::map_of(&steps)))
            }
            SolidText::Hollow { solid, keep } => {
                let (shell, priority) = self.leaf(&solid, material)?;
                let factors = self.checked(&keep, |(x, y, z)| {
                    coordinate(x).and(coordinate(y)).and(coordinate(z)).map(|_| DVec3::new(x, y, z))
                })?;
                let shell = shell.hollow(factors).map_err(|message| node.error(self.text, message))?;
                Ok(Solid::Leaf { shell, priority })
            }
            _ => {
                let (shell, priority) = self.leaf(node, material)?;
                Ok(Solid::Leaf { shell, priority })
            }
        }
    }

    fn operands(&mut self, node: &Node, nodes: &[Node], material: Option<u32>) -> Result<Vec<Solid>, InputError> {
        if nodes.len() < 2 {
            let message = format!("an operation needs at least 2 solids and has {}", nodes.len());
            return Err(node.error(self.text, message));
        }
        nodes.iter().map(|node| self.solid(node, material)).collect()
    }

    /// A closed shape of a solid with its priority.
    fn leaf(&mut self, node: &Node, default: Option<u32>) -> Result<(Shell, i32), InputError> {
        let (shell, material, priority) = match node.nested(self.text)? {
            SolidText::Cube { material, priority } => (Shell::cube(), material, priority),
            SolidText::Sphere { slices, material, priority } => {
                (Shell::sphere(self.slices(&slices)?), material, priority)
            }
            SolidText::Cone { slices, material, priority } => (Shell::cone(self.slices(&slices)?), material, priority),
            SolidText::Cylinder { slices, material, priority } => {
                (Shell::cylinder(self.slices(&slices)?), material, priority)
            }
            SolidText::Torus { r, slices, material, priority } => {
                let radius = self.checked(&r, tube_radius)?;
                (Shell::torus(radius, self.slices(&slices)?), material, priority)
            }
            SolidText::Prism { points, material, priority } => {
                let point =
                    |text| self.checked(text, |(x, y)| coordinate(x).and(coordinate(y)).map(|_| DVec2::new(x, y)));
                let points: Vec<DVec2> = points.iter().map(point).collect::<Result<_, _>>()?;
                let shell = Shell::prism(&points).map_err(|message| node.error(self.text, message))?;
                (shell, material, priority)
            }
            SolidText::Solid { shape, material, priority } => {
                let material = material.as_ref().map(|name| self.material_number(name)).transpose()?.or(default);
                return Ok((self.closed_mesh(node, &shape, material)?, priority.unwrap_or_default()));
            }
            SolidText::Union(_)
            | SolidText::Intersection(_)
            | SolidText::Difference(_)
            | SolidText::Place(..)
            | SolidText::Hollow { .. } => {
                let error = node.error(self.text, "a hollow shape is made of one primitive or closed mesh");
                return Err(error.help("place, join and cut what is hollow already: Place([...], Hollow(solid: Cube(), keep: (0.9, 0.9, 0.9)))"));
            }
        };
        let material = material.as_ref().map(|name| self.material_number(name)).transpose()?.or(default).unwrap_or(0);
        Ok((shell.of_material(material), priority.unwrap_or_default()))
    }

    /// A mesh as a closed shape, of one material or of its own.
    fn closed_mesh(&mut self, node: &Node, shape: &ShapeText, material: Option<u32>) -> Result<Shell, InputError> {
        if matches!(shape, ShapeText::Csg(_)) {
            return Err(node
                .error(self.text, "a solid within a solid needs neither `Solid` nor `Csg`")
                .help("leave both out"));
        }
        let mut shape = self.shape(shape)?;
        if shape.mesh.has_colors() {
            self.draft.notes.push("points' own colours are left out in solids".to_owned());
            shape.mesh.colors.clear();
        }
        let first = if shape.materials.is_empty() { 0 } else { self.draft.materials.len() as u32 };
        self.draft.notes.extend(shape.notes);
        let (mut shell, turned) = Shell::of_mesh(shape.mesh).map_err(|message| node.error(self.text, message))?;
        if turned {
            self.draft.notes.push("a solid's mesh was inside out and was turned over".to_owned());
        }
        match material {
            Some(material) => Ok(shell.of_material(material)),
            None => {
                self.draft.materials.extend(shape.materials);
                shell.change_materials(&mut |own| first + own);
                Ok(shell)
            }
        }
    }

    fn slices(&self, text: &Option<Located<u32>>) -> Result<u32, InputError> {
        let (least, most) = ReadOptions::RESOLUTIONS.into_inner();
        let check = |slices| match ReadOptions::RESOLUTIONS.contains(&slices) {
            true => Ok(slices),
            false => Err(format!("a shape of {slices} slices cannot be, there may be {least} to {most}")),
        };
        text.as_ref().map_or(Ok(self.options.resolution), |text| self.checked(text, check))
    }
}

fn tube_radius(radius: f64) -> Result<f64, String> {
    if radius > 0.0 && radius < 1.0 {
        Ok(radius)
    } else {
        Err(format!("radius of a torus' tube is {radius}, it must be above 0 and below 1: its ring has radius 1"))
    }
}
