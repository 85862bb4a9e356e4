//! What the texture verbs say to pictures that are none, damaged or absurd, and to options that
//! make no sense: one line that names the file or the option, and nothing left behind.

use crate::maps;
use crate::support;
use crate::surfaces;

use asperity_surface::image_io::save_gray16;
use asperity_surface::raster::Raster;
use maps::with_maps;
use support::{asperity, assert_refused, message};
use surfaces::ground;

/// A PNG that promises 100 000 × 100 000 texels.
fn bomb() -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend([0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0, 8, 2, 0, 0, 0]);
    let checksum = header.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    });
    let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    file.extend(header);
    file.extend((!checksum).to_be_bytes());
    file
}

#[test]
fn pictures_that_are_none_are_refused_by_name_and_leave_nothing() {
    let scene = with_maps(&[("good.png", ground(64)), ("tiny.png", ground(64).clone())]);
    save_gray16(scene.path("tiny.png"), &Raster::constant(3, 2, 0.4)).unwrap();
    let whole = std::fs::read(scene.path("good.png")).unwrap();
    scene.write("cut.png", &whole[..whole.len() / 2]);
    scene.write("text.png", "this is no picture");
    scene.write("empty.png", "");
    scene.write("bomb.png", bomb());
    std::fs::create_dir(scene.path("folder.png")).unwrap();
    for bad in ["missing.png", "cut.png", "text.png", "empty.png", "bomb.png", "folder.png", "tiny.png"] {
        for arguments in [
            &["texture", "metamer", bad, "good.png", "-o", "out.png"][..],
            &["texture", "metamer", "good.png", bad, "-o", "out.png"],
            &["texture", "from-normals", bad, "-o", "out.png"],
            &["texture", "from-photo", bad, "-o", "out"],
            &["texture", "analyze", bad],
        ] {
            // Six texels are too few for every verb, each in its own words.
            assert_refused(&asperity(scene.folder.path(), arguments), &[bad]);
            assert!(!scene.path("out.png").exists() && !scene.path("out/scene.toml").exists());
        }
        if bad != "tiny.png" {
            assert_refused(&asperity(scene.folder.path(), &["texture", "compare", "good.png", bad]), &[bad]);
        }
    }
    assert_refused(
        &asperity(
            scene.folder.path(),
            &["texture", "metamer", "good.png", "good.png", "-o", "no/such/folder.png"],
        ),
        &["folder"],
    );
}

/// A blank reference took a minute, and blank pictures gave flat surfaces without a word.
#[test]
fn a_blank_reference_and_a_blank_normal_map_are_reported_flat() {
    let scene = with_maps(&[("good.png", ground(64))]);
    for (name, grey) in [("white.png", 1.0), ("grey.png", 0.5), ("black.png", 0.0)] {
        save_gray16(scene.path(name), &Raster::constant(64, 64, grey)).unwrap();
        for (arguments, word) in [
            (&["metamer", "good.png", name, "-o", "out.png"][..], "warning: the reference is flat"),
            (&["from-normals", name, "-o", "out.png"], "warning: all normals of the map are alike"),
        ] {
            let all: Vec<&str> = std::iter::once("texture").chain(arguments.iter().copied()).collect();
            let (status, said, err) = message(&asperity(scene.folder.path(), &all));
            assert!(status == 0 && said.contains(word), "{arguments:?}: {said}{err}");
        }
    }
}

/// A map whose x lies in alpha was called a photograph, or lacked the word where its ribs lie along
/// u.
#[test]
fn a_normal_map_with_x_in_alpha_is_told_from_a_photograph() {
    let scene = with_maps(&[]);
    let level = |place: u32| (127.5 + 40.0 * (f64::from(place) * 0.4).sin()).round() as u8;
    let grey = |x: u32, y: u32| image::Rgba([level(y), level(y), level(y), level(x)]);
    let white = |x: u32, y: u32| image::Rgba([255, level(y), level(y), level(x)]);
    let ribs = |x: u32, _: u32| image::Rgba([0, 128, 0, level(x)]);
    image::RgbaImage::from_fn(64, 64, grey).save(scene.path("grey.png")).unwrap();
    image::RgbaImage::from_fn(64, 64, white).save(scene.path("white.png")).unwrap();
    image::RgbaImage::from_fn(64, 64, ribs).save(scene.path("ribs.png")).unwrap();
    let run = |name, more: &[&str]| {
        let all = [&["texture", "from-normals", name, "-o", "out.png"], more].concat();
        message(&asperity(scene.folder.path(), &all))
    };
    for name in ["grey.png", "white.png", "ribs.png"] {
        let (status, said, err) = run(name, &[]);
        assert_eq!(status == 0, name == "ribs.png", "{name}: {said}{err}");
        assert!(format!("{said}{err}").contains("write --x-in-alpha"), "{name}: {said}{err}");
        let (status, said, err) = run(name, &["--x-in-alpha"]);
        assert!(status == 0 && !said.contains("warning"), "{name}: {said}{err}");
    }
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let scene = with_maps(&[("a.png", ground(64))]);
    let run = |arguments: &[&str]| {
        let mut all = vec!["texture"];
        all.extend(arguments);
        asperity(scene.folder.path(), &all)
    };
    for usage in [
        &["metamer", "a.png", "a.png", "-o", "o.png", "--iterations", "0"][..],
        &["metamer", "a.png", "a.png", "-o", "o.png", "--mm-per-px", "0.1"],
        &["metamer", "a.png", "a.png", "-o", "o.png", "--mm-per-px", "nan", "--reference-mm-per-px", "1"],
        &["metamer", "a.png", "a.png"],
        &["compare", "a.png"],
        &["compare", "a.png", "a.png", "--strokes", "3"],
        &["compare", "a.png", "a.png", "--relief-m", "-1"],
        &["from-normals", "a.png", "-o", "o.png", "--green", "sideways"],
        &["from-normals", "a.png", "-o", "o.png", "--width-m", "inf"],
        &["from-normals", "a.png", "-o", "o.png", "--width-m", "0.04", "--width-mm", "50"],
        &["from-photo", "a.png", "-o", "o", "--light", "0,0,-1"],
        &["from-photo", "a.png", "-o", "o", "--light", "1,2"],
        &["from-photo", "a.png", "-o", "o", "--exaggerate", "0"],
        &["from-photo", "a.png", "-o", "o", "--width-m", "0.04", "--width-mm", "50"],
    ] {
        let (status, out, err) = message(&run(usage));
        assert_eq!((status, out.as_str()), (2, ""), "{usage:?}: {err}");
    }
    for (bad, field) in [
        (&["metamer", "a.png", "a.png", "-o", "o.png", "--bands", "9"][..], "bands"),
        (&["metamer", "a.png", "a.png", "-o", "o.png", "--bands", "0"], "bands"),
        (&["metamer", "a.png", "a.png", "-o", "o.png", "--orientations", "99"], "orientations"),
        (
            &[
                "metamer",
                "a.png",
                "a.png",
                "-o",
                "o.png",
                "--mm-per-px",
                "1000",
                "--reference-mm-per-px",
                "1",
            ],
            "scale",
        ),
        (&["from-photo", "a.png", "-o", "o", "--relief-m", "1e9"], "relief_m"),
    ] {
        assert_refused(&run(bad), &[field]);
    }
    assert!(!scene.path("o.png").exists());
}
