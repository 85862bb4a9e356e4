//! The tests of pictures, in one program.

mod analysis_against_numpy;
#[path = "support/exact_brownian.rs"]
mod exact_brownian;
mod flat_ground;
mod fractal_dimension_on_exact_surfaces;
#[path = "support/framed.rs"]
mod framed;
mod friezes;
mod from_photo;
mod lattice_and_group_tables;
mod lattice_of_few_repeats;
mod lattice_of_frames;
mod metamer;
mod normal_map;
mod normal_map_limits;
mod normal_maps_as_people_have_them;
mod normals;
#[path = "support/patterns.rs"]
mod patterns;
mod pyramid;
mod shape_from_shading;
mod surfaces;
#[path = "support/wallpaper.rs"]
mod wallpaper;
mod walls_in_jpeg;
