//! The host: it sends rays into the array and makes an image of the hits.

pub mod camera;
pub mod image;
pub mod ray_file;
