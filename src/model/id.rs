//! Names of what a scene holds: a place, and which of its occupants is meant.

/// A place in a scene's table and the number of the occupant, from 1 on, so that a name outlives
/// what it named without ever naming what comes after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SlotKey {
    pub(crate) index: u32,
    pub(crate) generation: u32,
}

impl SlotKey {
    fn to_bits(self) -> u64 {
        u64::from(self.generation) << 32 | u64::from(self.index)
    }

    fn from_bits(bits: u64) -> Self {
        Self { index: bits as u32, generation: (bits >> 32) as u32 }
    }
}

macro_rules! ids {
    ($($(#[doc = $doc:literal])+ $name:ident),+ $(,)?) => {$(
        $(#[doc = $doc])+
        ///
        /// 64 bits: the place in the lower half, and in the upper one which of its occupants. Once
        /// that one is gone, every call that is given its id refuses it, however often the place is
        /// used again.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub(crate) SlotKey);

        impl std::fmt::Display for $name {
            /// Its place, and from the second occupant on which one it is: `3`, `3.2`.
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match self.0 {
                    SlotKey { index, generation: 0 | 1 } => write!(f, "{index}"),
                    SlotKey { index, generation } => write!(f, "{index}.{generation}"),
                }
            }
        }

        impl $name {
            /// As a number that another language or a file can hold; never 0.
            #[must_use]
            pub fn to_bits(self) -> u64 {
                self.0.to_bits()
            }

            /// The id that [`to_bits`](Self::to_bits) gave. A number that is none is an id that
            /// every call refuses.
            #[must_use]
            pub fn from_bits(bits: u64) -> Self {
                Self(SlotKey::from_bits(bits))
            }

            /// Index in the engine's tables.
            pub(crate) fn index(self) -> usize {
                self.0.index as usize
            }
        }
    )+};
}

ids! {
    /// A surface of a [`Scene`](crate::Scene).
    SurfaceId,
    /// A ringing body of a [`Scene`](crate::Scene).
    BodyId,
    /// A probe of a [`Scene`](crate::Scene).
    ProbeId,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_survives_as_a_number() {
        let id = BodyId(SlotKey { index: 7, generation: u32::MAX });
        assert_eq!((BodyId::from_bits(id.to_bits()), id.index()), (id, 7));
        assert_eq!(id.to_bits(), 0xffff_ffff_0000_0007);
        assert_eq!(id.to_string(), "7.4294967295");
        assert_eq!(SurfaceId(SlotKey { index: 3, generation: 1 }).to_string(), "3");
    }
}
