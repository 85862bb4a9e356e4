//! Ports: what leaves the engine besides samples.

use crate::exchange::{answer, done};
use crate::session;
use asperity::ChannelId;
use asperity::live::ports::{Feed, Levels, Picture};

/// Time of a port's output that waits for a late page, s.
const HOLDS_S: f64 = 0.25;

/// Opens the levels of a haptic channel, `rate_hz` a second, in the place of those before.
#[unsafe(no_mangle)]
pub extern "C" fn asp_open_levels(channel: u32, rate_hz: f64) -> u32 {
    done(session::with(|session| {
        let channel = u16::try_from(channel).map_err(|_| format!("channel: {channel} is none"))?;
        session.ports.levels = None;
        let levels = Levels { from: Feed::Haptic(ChannelId(channel)), rate_hz, holds_s: HOLDS_S };
        session.ports.levels = Some(session.scene.open_port(levels).map_err(|error| error.to_string())?);
        Ok(())
    }))
}

/// The newest level of the heavy motor (0) or the light one (1), as the peak of a sine in the unit
/// of the samples; 0 where no port is open.
#[unsafe(no_mangle)]
pub extern "C" fn asp_level(motor: u32) -> f64 {
    let mut level = 0.0;
    session::if_open(|session| {
        if let Some(port) = &mut session.ports.levels {
            level = port.newest()[usize::from(motor != 0)];
        }
    });
    level
}

/// Opens the picture of surface `index`, in the place of the one before; refused where it never
/// changes.
#[unsafe(no_mangle)]
pub extern "C" fn asp_open_picture(index: u32) -> u32 {
    done(session::with(|session| {
        let surface = *session.surfaces.get(index as usize).ok_or("there is no such surface")?;
        let port = session.scene.open_port(Picture { surface }).map_err(|error| error.to_string())?;
        let [columns, rows] = port.picture().size();
        let read = [columns as f32, rows as f32, port.picture().cell_m() as f32];
        answer(read.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>());
        session.ports.picture = Some(port);
        Ok(())
    }))
}

/// The tiles that have changed since the last call. Outbox: of each tile its first column and row,
/// its columns and rows, then its heights in metres above the bottom, all as 32-bit floating point.
/// Tells how many tiles there are.
#[unsafe(no_mangle)]
pub extern "C" fn asp_read_picture() -> usize {
    let mut count = 0;
    session::if_open(|session| {
        let Some(port) = &mut session.ports.picture else { return };
        let mut bytes = Vec::new();
        count = port.changed(|tile| {
            let [[x, y], [columns, rows]] = [tile.at, tile.size];
            for number in [x, y, columns, rows] {
                bytes.extend((number as f32).to_le_bytes());
            }
            bytes.extend(tile.height_m.iter().flat_map(|height| height.to_le_bytes()));
        });
        if count > 0 {
            answer(bytes);
        }
    });
    count
}
