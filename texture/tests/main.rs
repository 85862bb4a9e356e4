//! The tests of surfaces and pictures, in one program.

mod analysis_against_numpy;
mod brownian;
mod combine;
mod common;
mod debanding;
#[path = "support/exact_brownian.rs"]
mod exact_brownian;
mod flat_ground;
mod fractal_dimension_on_exact_surfaces;
#[path = "support/framed.rs"]
mod framed;
mod friezes;
mod from_photo;
mod height_map_figures;
mod hollows;
mod lattice;
mod lattice_and_group_tables;
mod lattice_of_few_repeats;
mod lattice_of_frames;
#[path = "common/materials.rs"]
mod materials;
mod metamer;
mod moving_sand;
#[path = "common/naive_sand.rs"]
mod naive_sand;
mod no_allocation;
mod normal_map;
mod normal_map_as_heights;
mod normal_map_limits;
mod normal_maps_as_people_have_them;
mod normals;
#[path = "support/patterns.rs"]
mod patterns;
mod pyramid;
mod real_maps;
mod sand;
mod sand_source;
mod seven_materials;
mod shape_from_shading;
mod solid_noise;
mod surfaces;
mod triplanar;
#[path = "support/wallpaper.rs"]
mod wallpaper;
mod walls_in_jpeg;
