//! DualSense: by cable four channels at 48 kHz, of which the third and fourth drive the actuators;
//! by air packets of 64 bytes, 32 frames of two signed bytes at 3 kHz. Neither is documented by its
//! maker: both as several users report them.

/// Rate by cable, Hz.
pub const CABLE_RATE_HZ: f64 = 48_000.0;
/// Rate by air, Hz.
pub const AIR_RATE_HZ: f64 = 3000.0;
/// Bytes of a packet.
pub const PACKET_BYTES: usize = 64;

/// Frames of four channels: sound left and right, actuator left and right. The shorter ones end in
/// silence.
#[must_use]
pub fn four_channels(sound: [&[f32]; 2], actuators: [&[f32]; 2]) -> Vec<[f32; 4]> {
    let all = [sound[0], sound[1], actuators[0], actuators[1]];
    let frames = all.iter().map(|channel| channel.len()).max().unwrap_or(0);
    let sample = |channel: &[f32], n: usize| channel.get(n).copied().filter(|x| x.is_finite()).unwrap_or(0.0);
    (0..frames).map(|n| all.map(|channel| sample(channel, n).clamp(-1.0, 1.0))).collect()
}

/// Packets for the air; the last one ends in silence.
#[must_use]
pub fn packets(actuators: [&[f32]; 2]) -> Vec<[i8; PACKET_BYTES]> {
    let frames = actuators.map(<[f32]>::len).into_iter().max().unwrap_or(0);
    let byte = |channel: &[f32], n: usize| {
        let x = channel.get(n).copied().filter(|x| x.is_finite()).unwrap_or(0.0);
        (x.clamp(-1.0, 1.0) * 127.0).round() as i8
    };
    (0..frames.div_ceil(PACKET_BYTES / 2))
        .map(|packet| {
            let first = packet * PACKET_BYTES / 2;
            std::array::from_fn(|i| byte(actuators[i % 2], first + i / 2))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_actuators_are_the_third_and_fourth_channel() {
        let frames = four_channels([&[0.1, 0.2], &[0.3]], [&[0.5], &[f32::NAN, 7.0]]);
        assert_eq!(frames, [[0.1, 0.3, 0.5, 0.0], [0.2, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn a_packet_holds_32_frames_of_two_bytes() {
        let left = [1.0_f32; 33];
        let packets = packets([&left, &[-1.0]]);
        assert_eq!(packets.len(), 2);
        assert_eq!((packets[0][0], packets[0][1], packets[0][2], packets[0][3]), (127, -127, 127, 0));
        assert_eq!((packets[1][0], packets[1][2]), (127, 0));
    }
}
