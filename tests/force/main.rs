//! The 3-D force: the documents' laws at the ticks of a device, at every rate, from a force or from
//! a depth.

mod depths;
mod laws;
mod readers;
mod stroke;
