//! Notices to a game about its things, each given once a thing.

use std::fmt;

/// Gravity beyond which the game's unit is taken for the centimetre, m/s²: four times that of
/// Jupiter.
pub const ODD_GRAVITY_M_S2: f32 = 100.0;
/// Size beyond which a thing that moves is taken for one in centimetres, m.
pub const ODD_SIZE_M: f32 = 100.0;

/// Something about a thing, or about the world, that is heard wrong or not at all.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// Gravity is that of a world in centimetres.
    Gravity {
        /// It, m/s² if the unit is the metre.
        m_s2: f32,
    },
    /// A thing that moves is larger than a house.
    Size {
        /// Its longest half side, m if the unit is the metre.
        m: f32,
    },
    /// Something slides on it, and nothing tells where on its surface.
    Unplaced,
    /// A hand whose contacts with fixed ground the physics engine does not list.
    Unlisted,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gravity { m_s2 } => write!(
                f,
                "gravity is {m_s2}: asperity takes metres; scale the physics, or divide lengths, speeds and gravity by 100"
            ),
            Self::Size { m } => write!(f, "it moves and is {m} long from its middle: asperity takes metres"),
            Self::Unplaced => write!(
                f,
                "something slides on it, but its mapping has no texture coordinates there: a mesh's mapping wants a triangle mesh with a \
                 coordinate for each vertex; anything else a plane, or a mapping by the normal"
            ),
            Self::Unlisted => write!(
                f,
                "it is kinematic and felt, but its contacts with fixed ground are not listed: \
                 set ActiveCollisionTypes::all() on its collider"
            ),
        }
    }
}
