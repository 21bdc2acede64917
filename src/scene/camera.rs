//! The eye, and the one that frames a scene which has none.

use glam::{DVec3, Vec3};

/// Angle of view of a camera that is made for a scene without one, in degrees.
const FRAMING_ANGLE: f64 = 40.0;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub from: Vec3,
    /// The point in the middle of the image.
    pub at: Vec3,
    /// The direction that is up in the image; not parallel to the line of sight.
    pub up: Vec3,
    /// Full angle of view of the image's height, in degrees, above 0 and below 180.
    pub angle: f32,
}

/// What is wrong with a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraFault {
    /// The eye is in the point that it looks at.
    NoLineOfSight,
    /// The direction that is up is zero or parallel to the line of sight.
    NoUp,
    /// The angle of view is not above 0 and below 180 degrees.
    Angle,
}

impl CameraFault {
    /// The fault as a sentence without a final stop.
    pub fn message(self) -> &'static str {
        match self {
            CameraFault::NoLineOfSight => "camera is in the very point that it looks at",
            CameraFault::NoUp => "camera's up direction is parallel to its line of sight",
            CameraFault::Angle => "camera's angle must be above 0 and below 180 degrees",
        }
    }
}

impl Camera {
    /// A camera that sees the whole of a box from three quarters and a little above: the box's bounding sphere just
    /// fits into the image's height.
    ///
    /// `low` and `high` are the box's corners, `up` is the scene's vertical.
    pub fn framing(low: Vec3, high: Vec3, up: Vec3) -> Self {
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let middle = (low + high) / 2.0;
        // A scene smaller than the rounding of its coordinates still needs an eye outside of it.
        let rounding = middle.length() * 1e-5;
        let radius = match (high - low).length() / 2.0 {
            0.0 => 1.0,
            radius => radius,
        };
        let distance = radius.max(rounding) / (FRAMING_ANGLE / 2.0).to_radians().sin();
        let from = middle + three_quarter_view(up.as_dvec3().normalize_or(DVec3::Z)) * distance;
        Camera { from: from.as_vec3(), at: middle.as_vec3(), up, angle: FRAMING_ANGLE as f32 }
    }

    /// Checks that there is a line of sight, an up direction and an angle of view.
    pub fn check(&self) -> Result<(), CameraFault> {
        let sight = (self.at.as_dvec3() - self.from.as_dvec3()).normalize_or_zero();
        let up = self.up.as_dvec3().normalize_or_zero();
        if sight == DVec3::ZERO {
            Err(CameraFault::NoLineOfSight)
        } else if sight.cross(up).length() < 1e-6 {
            Err(CameraFault::NoUp)
        } else if !(self.angle > 0.0 && self.angle < 180.0) {
            Err(CameraFault::Angle)
        } else {
            Ok(())
        }
    }
}

/// The unit vector from the scene to the eye: to the right, in front and above.
fn three_quarter_view(up: DVec3) -> DVec3 {
    let right = if up.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let right = right.reject_from_normalized(up).normalize();
    let front = right.cross(up);
    (right + 1.6 * front + 0.9 * up).normalize()
}
