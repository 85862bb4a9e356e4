//! Strokes made with known ground, read back.

mod made;
mod colour;
mod octaves;
mod lines;
