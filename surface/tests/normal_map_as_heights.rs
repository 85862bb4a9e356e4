//! A normal map that is named as a displacement map is refused; every other picture of the corpus
//! is taken.
#![cfg(feature = "image")]

use asperity_evidence::corpus::corpus;
use asperity_surface::image_io::{Channel, Problem, load_channel, load_map};

#[test]
fn of_all_pictures_at_hand_normal_maps_alone_are_refused_as_heights() {
    let Some(folders) = ["textures", "photos"].map(corpus).into_iter().collect::<Option<Vec<_>>>() else {
        return;
    };
    let (mut refused, mut taken) = (0, 0);
    for file in folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap()) {
        let path = file.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if load_channel(&path, Channel::Luma).is_err() {
            continue;
        }
        match load_map(&path, Channel::Luma) {
            Ok(_) => taken += 1,
            Err(error) => {
                assert!(matches!(error.problem, Problem::IsNormalMap), "{error}");
                assert!(name.contains("Normal"), "{name} is no normal map");
                refused += 1;
            }
        }
    }
    assert!(refused >= 1 && taken >= 15, "{refused} refused, {taken} taken");
}
