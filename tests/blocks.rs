//! Any split of time into blocks, and any second run, gives the same bits.

use crate::common;

use asperity::offline::Options;
use asperity::{ContactBlock, Tap};
use common::{SIDE_M, bar, plate, render, render_tapped, si_config, stroke};

#[test]
fn every_block_size_renders_the_same_bits() {
    let log = stroke(SIDE_M, 0.15, 0.6, 0.4);
    let _ = bar();
    let with = |block_frames| {
        let options = Options { block_frames, tail_s: 0.3, ..Options::default() };
        let take = render(si_config(), plate(0.8), &log, &options);
        (take.audio, take.haptic)
    };
    let reference = with(256);
    assert!(common::peak(&reference.0[0]) > 0.0 && common::peak(&reference.1[0]) > 0.0);
    for block_frames in [1, 2, 7, 63, 64, 65, 100, 441, 1024, 4096] {
        assert!(with(block_frames) == reference, "blocks of {block_frames} differ");
    }
    assert!(with(256) == reference, "a second run differs");
}

/// Every number that a tap sees, as bits.
#[derive(Default)]
struct Bits(Vec<u64>);

impl Tap for Bits {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for (i, row) in block.contact_samples.iter().enumerate() {
            self.0.push(block.first_sample + i as u64);
            let [u, v] = block.uv[i];
            let numbers = [u, v, row.height_m, row.pad_m, row.contact_force_n, block.impulse_n_s[i]];
            self.0.extend(numbers.map(f64::to_bits));
        }
    }
}

#[test]
fn what_is_traced_and_counted_does_not_depend_on_the_blocks_either() {
    let log = stroke(SIDE_M, 0.3, 0.4, 0.3);
    let with = |block_frames| {
        let options = Options { block_frames, tail_s: 0.2, ..Options::default() };
        let mut bits = Bits::default();
        let take = render_tapped(si_config(), plate(1.0), &log, &options, &mut bits);
        (bits.0, take.stats.micro_collisions, take.stats.events)
    };
    let reference = with(256);
    assert!(reference.1 > 10, "the stroke has to bounce");
    for block_frames in [1, 2, 63, 64, 65, 4096] {
        assert!(with(block_frames) == reference, "blocks of {block_frames} differ");
    }
}
