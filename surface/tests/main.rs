//! The tests of surfaces, in one program.

mod brownian;
mod combine;
mod common;
mod debanding;
mod grating;
mod height_map_figures;
mod hollows;
mod lattice;
#[path = "common/materials.rs"]
mod materials;
mod moving_sand;
#[path = "common/naive_sand.rs"]
mod naive_sand;
mod no_allocation;
mod normal_map_as_heights;
mod real_maps;
mod sand;
mod sand_source;
mod seven_materials;
mod solid_noise;
mod triplanar;
