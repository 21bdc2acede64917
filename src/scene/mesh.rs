//! Polygons that share corners.

use glam::Vec3;

/// A corner's normal where the face has none of its own there.
pub const NO_NORMAL: u32 = u32::MAX;

/// Faces over shared points, in file order.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The points that corners refer to.
    pub points: Vec<Vec3>,
    /// The normals that corners refer to; not necessarily of unit length.
    pub normals: Vec<Vec3>,
    /// The points' own colours; those beyond its end have none, and in most scenes it is empty.
    pub(super) colors: Vec<Option<Vec3>>,
    /// For each object, the number of its first face, in rising order.
    pub(super) objects: Vec<u32>,
    /// Faces of the file behind the last one here, which were passed over.
    pub(super) passed_over: u32,
    corners: Vec<Corner>,
    faces: Vec<Face>,
}

/// One corner of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Index into [`Mesh::points`].
    pub point: u32,
    /// Index into [`Mesh::normals`], or [`NO_NORMAL`].
    pub normal: u32,
}

/// One face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    first: u32,
    count: u32,
    /// Index into the scene's materials.
    pub material: u32,
    /// The number of the file's face that this one is, or is a piece of, from 0 in file order.
    pub number: u32,
}

/// What one looks at as one thing: faces that belong together and are made of the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Object {
    /// How many objects begin before its end in the file.
    part: u32,
    material: u32,
}

impl Object {
    /// A number that no other object of the same mesh has.
    pub fn number(self) -> u64 {
        u64::from(self.part) << 32 | u64::from(self.material)
    }
}

impl Mesh {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        let Mesh { points, normals, colors, objects, passed_over: _, corners, faces } = self;
        let of_points = size_of_val(&points[..]) + size_of_val(&normals[..]) + size_of_val(&colors[..]);
        (of_points + size_of_val(&objects[..]) + size_of_val(&corners[..]) + size_of_val(&faces[..])) as u64
    }

    /// Adds a point and returns its index.
    pub fn add_point(&mut self, point: Vec3) -> u32 {
        self.points.push(point);
        (self.points.len() - 1) as u32
    }

    /// Gives the last point a colour of its own (linear RGB), which takes the place of its faces' material's.
    pub fn color_point(&mut self, color: Vec3) {
        self.colors.resize(self.points.len().saturating_sub(1), None);
        self.colors.push(Some(color));
    }

    /// A point's own colour, if it has one.
    pub fn point_color(&self, point: u32) -> Option<Vec3> {
        self.colors.get(point as usize).copied().flatten()
    }

    /// Whether any point has a colour of its own.
    pub fn has_colors(&self) -> bool {
        !self.colors.is_empty()
    }

    /// Begins an object: the faces added from here on, up to the next one, belong together.
    pub fn begin_object(&mut self) {
        let first = self.face_count();
        if self.objects.last() != Some(&first) {
            self.objects.push(first);
        }
    }

    /// The object that a face of this mesh belongs to.
    pub fn object(&self, face: &Face) -> Object {
        Object { part: self.part(face), material: face.material }
    }

    /// How many objects begin before a face's end.
    pub(super) fn part(&self, face: &Face) -> u32 {
        self.objects.partition_point(|&first| first <= face.number) as u32
    }

    /// Adds a normal and returns its index.
    pub fn add_normal(&mut self, normal: Vec3) -> u32 {
        self.normals.push(normal);
        (self.normals.len() - 1) as u32
    }

    /// Adds a flat face over `points`, numbered as the next face of the file.
    pub fn add_face(&mut self, points: &[u32], material: u32) {
        let number = self.face_count();
        self.add_piece(points.iter().map(|&point| Corner { point, normal: NO_NORMAL }), material, number);
    }

    /// Adds a face with normals at its corners, numbered as the next face of the file.
    pub fn add_smooth_face(&mut self, corners: &[Corner], material: u32) {
        let number = self.face_count();
        self.add_piece(corners.iter().copied(), material, number);
    }

    /// Adds a face that is, or is a piece of, the file's face `number`.
    pub fn add_piece(&mut self, corners: impl IntoIterator<Item = Corner>, material: u32, number: u32) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners);
        let count = self.corners.len() as u32 - first;
        self.passed_over = 0;
        self.faces.push(Face { first, count, material, number });
    }

    /// Adds what another mesh has, as objects of its own; `material` gives the new number of each material.
    pub fn append(&mut self, mesh: Mesh, material: impl Fn(u32) -> u32) {
        let (first_point, first_normal) = (self.points.len() as u32, self.normals.len() as u32);
        let moved = |corner: &Corner| Corner {
            point: first_point + corner.point,
            normal: if corner.normal == NO_NORMAL { NO_NORMAL } else { first_normal + corner.normal },
        };
        let first_face = self.face_count();
        self.begin_object();
        self.objects.extend(mesh.objects.iter().filter(|&&first| first > 0).map(|first| first_face + first));
        for face in mesh.faces() {
            self.add_piece(mesh.corners(face).iter().map(moved), material(face.material), first_face + face.number);
        }
        self.passed_over += first_face + mesh.face_count() - self.face_count();
        if mesh.has_colors() {
            self.colors.resize(first_point as usize, None);
            self.colors.extend(mesh.colors);
        }
        self.points.extend(mesh.points);
        self.normals.extend(mesh.normals);
    }

    /// Turns every face over.
    pub(super) fn reverse_faces(&mut self) {
        for face in &self.faces {
            self.corners[face.first as usize..(face.first + face.count) as usize].reverse();
        }
    }

    /// Takes normals that there are not from the corners.
    pub(super) fn drop_missing_normals(&mut self) {
        let count = self.normals.len();
        let missing = self.corners.iter_mut().filter(|corner| corner.normal as usize >= count);
        missing.for_each(|corner| corner.normal = NO_NORMAL);
    }

    /// Leaves out a face of the file, which keeps its number.
    pub fn pass_over_face(&mut self) {
        self.passed_over += 1;
    }

    /// The faces, in file order.
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The corners of a face of this mesh.
    pub fn corners(&self, face: &Face) -> &[Corner] {
        &self.corners[face.first as usize..(face.first + face.count) as usize]
    }

    /// The points of a face of this mesh, in order.
    pub fn face_points<'a>(&'a self, face: &Face) -> impl ExactSizeIterator<Item = Vec3> + Clone + 'a {
        self.corners(face).iter().map(|corner| self.points[corner.point as usize])
    }

    /// How many faces the file has: pieces of one face count once, and those that were passed over count, too.
    pub fn face_count(&self) -> u32 {
        self.faces.last().map_or(0, |face| face.number + 1) + self.passed_over
    }

    /// How many corners all faces have together.
    pub fn corner_count(&self) -> u64 {
        self.corners.len() as u64
    }

    /// The smallest axis-parallel box around all faces' points, or `None` without faces.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut points = self.corners.iter().map(|corner| self.points[corner.point as usize]);
        let first = points.next()?;
        Some(points.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
    }
}
