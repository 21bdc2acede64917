//! The host: it sends rays into the array, shades the hits, and makes an image of them.

pub mod camera;
pub mod color_table;
pub mod image;
pub mod occluders;
pub mod order;
pub mod policy;
pub mod ray_file;
pub mod rules;
pub mod sampling;
pub mod screen;
pub mod shades;
pub mod shading;
pub mod surface;
