//! The verb of the page, in a program that was built without it. `bindings/web/test` tests one that
//! carries it.

#![cfg(not(feature = "web"))]

mod support;

use support::{Scene, asperity, message};

#[test]
fn a_program_without_the_page_names_the_build_with_it() {
    let scene = Scene::new();
    for arguments in [&["web"][..], &["web", "--open"], &["web", "-o", "page"]] {
        let (status, out, err) = message(&asperity(scene.folder.path(), arguments));
        assert_eq!((status, out.as_str(), err.lines().count()), (1, "", 1), "{err}");
        assert!(err.starts_with("error: asperity web: ") && err.contains("bindings/web/build"), "{err}");
    }
    assert!(!scene.folder.path().join("page").exists());
}
