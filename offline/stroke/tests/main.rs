//! Strokes made with known ground, read back.

mod colour;
mod lines;
mod made;
mod octaves;
mod quantities;
mod sound;
