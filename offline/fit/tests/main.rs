//! The tests of fitting, in one program.

mod devices;
mod hostile;
mod recordings;
mod sound_files;
mod strikes;
mod synthetic;
