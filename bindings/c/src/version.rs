//! Version: of the library, and of the header that a program was compiled with.

use crate::body::{asp_body, asp_mode};
use crate::config::asp_config;
use crate::entry::{array, enter};
use crate::event::asp_event;
use crate::files::asp_files;
use crate::image::asp_image;
use crate::pairs::{asp_collider, asp_placed, asp_touch};
use crate::pickup::{asp_motion, asp_pickup};
use crate::player::{asp_player_config, asp_player_report};
use crate::port::{asp_force, asp_point, asp_port_config};
use crate::sized::Sized32;
use crate::stats::asp_stats;
use crate::status::{ASP_ABI_MISMATCH, Failure};
use crate::surface::asp_surface;
use std::mem::size_of;

/// Version of the interface: a program that was compiled with another one is refused by
/// `asp_check_abi`.
pub const ASP_ABI: u32 = 1;

/// Number of structs in the header, in the order in which `asp_check_abi` takes their sizes.
pub const ASP_STRUCTS: u32 = 18;

/// Name and sizes of a struct that begins with its size: all that it ever had.
const fn ages<T: Sized32>() -> (&'static str, &'static [u32]) {
    (T::NAME, T::SHIPPED)
}

const STRUCTS: [(&str, &[u32]); ASP_STRUCTS as usize] = [
    ages::<asp_config>(),
    ages::<asp_files>(),
    ("asp_image", &[size_of::<asp_image>() as u32]),
    ("asp_mode", &[size_of::<asp_mode>() as u32]),
    ages::<asp_body>(),
    ages::<asp_surface>(),
    ages::<asp_event>(),
    ages::<asp_stats>(),
    ages::<asp_port_config>(),
    ("asp_point", &[size_of::<asp_point>() as u32]),
    ("asp_force", &[size_of::<asp_force>() as u32]),
    ages::<asp_player_config>(),
    ages::<asp_player_report>(),
    ages::<asp_pickup>(),
    ("asp_motion", &[size_of::<asp_motion>() as u32]),
    ages::<asp_collider>(),
    ("asp_placed", &[size_of::<asp_placed>() as u32]),
    ("asp_touch", &[size_of::<asp_touch>() as u32]),
];

/// Version of the library: major · 65536 + minor · 256 + patch.
#[unsafe(no_mangle)]
pub extern "C" fn asp_version() -> u32 {
    let part = |text: &str| text.parse::<u32>().unwrap_or(0);
    part(env!("CARGO_PKG_VERSION_MAJOR")) << 16
        | part(env!("CARGO_PKG_VERSION_MINOR")) << 8
        | part(env!("CARGO_PKG_VERSION_PATCH"))
}

/// Tests whether a program and this library fit each other: `abi` is the header's `ASP_ABI`,
/// `sizes` those of its structs in the order config, files, image, mode, body, surface, event,
/// stats, port_config, point, force, player_config, player_report, pickup, motion, collider,
/// placed, touch. One sentence instead of a crash where a library lies beside another one's header;
/// structs of an older header of this interface are understood.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_check_abi(abi: u32, sizes: *const u32, count: u32) -> i32 {
    enter(|| {
        let right = "take header and library from the same release";
        let mismatch = |what: String| Failure::new(ASP_ABI_MISMATCH, format!("asperity: {what}; {right}"));
        if abi != ASP_ABI {
            return Err(mismatch(format!("the header is of interface {abi}, the library of {ASP_ABI}")));
        }
        let sizes = array(sizes, count as usize, STRUCTS.len(), "sizes")?;
        for (size, (name, ages)) in sizes.iter().zip(STRUCTS) {
            if let Some(own) = ages.last().filter(|_| !ages.contains(size)) {
                return Err(mismatch(format!("{name} has {size} bytes in the header, {own} in the library")));
            }
        }
        Ok(())
    })
}
