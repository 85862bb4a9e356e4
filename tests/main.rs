//! The engine's tests in one program, but for three that must be alone: threads that are timed, and
//! bits that other processors compare.

mod accepted_ranges;
mod another_rate;
mod apply;
mod blocks;
mod buses;
mod callbacks;
mod changes;
mod clips;
#[path = "common/closed_forms.rs"]
mod closed_forms;
mod common;
mod contact_force;
mod contacts_of_every_kind;
mod contacts_side_by_side;
mod contractive;
mod contradictions;
#[path = "common/counting.rs"]
mod counting;
mod debounce;
mod diffuse;
mod direct_current;
mod documents;
mod dragged_skin;
mod feel_of_tools;
mod finger_on_fabric;
#[path = "force/main.rs"]
mod force;
mod frames;
mod fuzz;
mod grating;
mod hostile;
mod imports;
mod kernels;
mod laps;
mod latency;
mod level_by_rate;
mod levels_as_shipped;
mod levels_over_the_grid;
mod live_clock;
mod live_is_offline;
mod live_levels;
mod many_fingers;
mod materials;
mod matte_and_shiny;
#[path = "../examples/real_input/modal_tables.rs"]
mod modal_tables;
#[path = "fuzz/mutation.rs"]
mod mutation;
mod one_shots;
mod only_what_is_needed;
mod own_sources;
mod parameters;
mod parts;
mod pickups;
mod ports;
mod pressed_harder;
#[path = "../examples/real_input/profile.rs"]
mod profile;
mod quiet;
mod radiating;
#[path = "common/random_ends.rs"]
mod random_ends;
#[path = "common/random_game.rs"]
mod random_game;
mod random_strokes;
mod rates;
mod real_input;
mod realtime;
mod recordings;
mod reports_of_games;
mod residual;
mod rollback;
mod rolling;
mod sand_at_rest;
mod scaled_bodies;
mod seven_materials;
mod seven_materials_judged;
mod several;
mod silence;
mod six_plates;
#[path = "common/slanting.rs"]
mod slanting;
#[path = "common/sliding.rs"]
mod sliding;
mod slow_motion;
mod soft_ground;
mod sound_grows;
mod stability;
#[path = "common/steps.rs"]
mod steps;
mod stick_slip;
mod stood_still;
mod storage;
mod strike_anywhere;
mod strike_field;
mod strikes;
mod swap;
#[path = "fuzz/targets.rs"]
mod targets;
mod threads;
#[path = "../examples/real_input/trajectories.rs"]
mod trajectories;
mod traps;
mod variation;
mod waves_are_heard;
mod what_strokes;
