//! The shapes in a modes file of version 2, for those who strike a body anywhere.

use crate::model::modal_model::{ModalModel, ModalModelError};
use crate::model::mode_shapes::{ModeShapes, Unit};
use std::path::Path;
use std::sync::Arc;

/// Reads the shapes of a modes file and its unit; none where it has none.
///
/// # Errors
/// When the file cannot be read or its shapes do not fit each other.
pub fn load_shapes(path: impl AsRef<Path>) -> Result<Option<(ModeShapes, Unit)>, ModalModelError> {
    ModalModel::load(path).map(shapes_of)
}

/// Reads the shapes of the text of a modes file and its unit; none where it has none.
///
/// # Errors
/// As [`load_shapes`].
pub fn parse_shapes(text: &str) -> Result<Option<(ModeShapes, Unit)>, ModalModelError> {
    ModalModel::parse(text).map(shapes_of)
}

fn shapes_of(model: ModalModel) -> Option<(ModeShapes, Unit)> {
    model.shapes.map(|shapes| (Arc::unwrap_or_clone(shapes), model.unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRA: &str = r#"{"format":"asperity.modes","version":2,"unit":"relative",
        "modes":[{"frequency_hz":812.4,"decay_per_s":14.2,"amplitude":0.5,"phase_rad":1.5}],
        "shapes":{"points_m":[[0,0,0],[1,0,0],[0,1,0]],"triangles":[[0,1,2]],"gains":[0.5],
        "phi_per_sqrt_kg":[[[0,0,1],[0,0,-1],[0,0,0.25]]],"struck_point":0}}"#;

    #[test]
    fn version_2_plays_at_its_struck_point_and_keeps_its_shapes() {
        let model = ModalModel::parse(TETRA).unwrap();
        assert_eq!(model.modes[0].amplitude, 0.5);
        let (shapes, unit) = parse_shapes(TETRA).unwrap().unwrap();
        assert_eq!(unit, Unit::Relative);
        assert_eq!(shapes.phi_per_sqrt_kg[0][2], [0.0, 0.0, 0.25]);
    }

    #[test]
    fn shapes_that_do_not_fit_the_modes_are_refused_with_the_place() {
        for (right, wrong, expected) in [
            ("\"gains\":[0.5]", "\"gains\":[]", "0 gains"),
            ("[[0,1,2]]", "[[0,1,3]]", "triangles"),
            ("\"version\":2", "\"version\":1", "version 2"),
            ("\"struck_point\":0", "\"struck_point\":7", "struck at 7"),
        ] {
            let text = TETRA.replace(right, wrong);
            let message = parse_shapes(&text).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
            assert!(ModalModel::parse(&text).is_err());
        }
    }

    #[test]
    fn version_1_has_no_shapes() {
        let text = r#"{"format":"asperity.modes","version":1,"modes":[]}"#;
        assert_eq!(parse_shapes(text).unwrap(), None);
    }
}
