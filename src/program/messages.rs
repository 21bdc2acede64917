//! The messages between the host and the cells, and their words (32 bits each).

/// RAY, on X: id, origin x y z, direction x y z, t_max.
pub const RAY_WORDS: u64 = 8;

/// Sub-volumes that a word of a RAY with a mask tells of, a bit each, behind its other words.
pub const MASK_BITS: u64 = 32;

/// CANDIDATE, on Y: a polygon's index; END, behind the last one, is as long.
pub const CANDIDATE_WORDS: u64 = 1;

/// HIT, on Y: the ray's id, the polygon's index, t, alpha, beta.
pub const HIT_WORDS: u64 = 5;

/// VOXEL, on Y, and the WORD on Z that answers it: see [stop words](super::ArrayProgram::stop_words).
pub const VOXEL_WORDS: u64 = 1;
