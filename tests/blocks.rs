//! Any split of time into blocks, and any second run, gives the same bits.

mod common;

use asperity::offline::Options;
use common::{SIDE_M, bar, plate, render, si_config, stroke};

#[test]
fn every_block_size_renders_the_same_bits() {
    let log = stroke(SIDE_M, 0.15, 0.6, 0.4);
    let _ = bar();
    let with = |block_frames| {
        let options = Options { block_frames, tail_s: 0.3 };
        let take = render(si_config(), plate(0.8), &log, &options);
        (take.audio, take.haptic)
    };
    let reference = with(256);
    assert!(common::peak(&reference.0) > 0.0 && common::peak(&reference.1[0]) > 0.0);
    for block_frames in [1, 2, 7, 63, 64, 65, 100, 441, 1024, 4096] {
        assert!(with(block_frames) == reference, "blocks of {block_frames} differ");
    }
    assert!(with(256) == reference, "a second run differs");
}
