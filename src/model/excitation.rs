//! Excitation: by what sliding rings the body, a set of exciters.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// One way in which a contact that slides rings what it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Exciter {
    /// Hertz pulses at the micro-collisions, as the paper does: silent where the pad never lifts
    /// off.
    Collisions,
    /// The alternating part of the contact force.
    Force,
    /// Friction along the motion, which sticks and slips with the body in every sample: bowed and
    /// squealing things.
    Friction,
}

impl Exciter {
    /// All there are, with the words that files use.
    pub const ALL: [(&str, Self); 3] =
        [("collisions", Self::Collisions), ("force", Self::Force), ("friction", Self::Friction)];

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Excitation of the body by sliding; empty: none, so that the body is rung by impacts alone.
///
/// ```
/// use asperity::{Excitation, Exciter};
///
/// let both = Excitation::NONE.with(Exciter::Collisions).with(Exciter::Force);
/// assert_eq!(both, Excitation::BOTH);
/// assert!(Excitation::COLLISIONS.has(Exciter::Collisions) && !Excitation::COLLISIONS.has(Exciter::Force));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Excitation(u8);

impl Excitation {
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// The paper's micro-collisions only.
    pub const COLLISIONS: Self = Self(Exciter::Collisions.bit());
    /// The alternating contact force only.
    pub const FORCE: Self = Self(Exciter::Force.bit());
    /// Friction only.
    pub const FRICTION: Self = Self(Exciter::Friction.bit());
    /// Micro-collisions and force, the default.
    pub const BOTH: Self = Self(Self::COLLISIONS.0 | Self::FORCE.0);

    /// Words that files may use for a whole set.
    pub(crate) const WORDS: [(&str, Self); 4] = [
        ("collisions", Self::COLLISIONS),
        ("force", Self::FORCE),
        ("friction", Self::FRICTION),
        ("both", Self::BOTH),
    ];

    /// Adds one more.
    #[must_use]
    pub const fn with(self, exciter: Exciter) -> Self {
        Self(self.0 | exciter.bit())
    }

    /// Tests whether it is among them.
    #[must_use]
    pub const fn has(self, exciter: Exciter) -> bool {
        self.0 & exciter.bit() != 0
    }
}

impl Default for Excitation {
    fn default() -> Self {
        Self::BOTH
    }
}

/// A list of words.
impl Serialize for Excitation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer
            .collect_seq(Exciter::ALL.iter().filter(|(_, exciter)| self.has(*exciter)).map(|(word, _)| word))
    }
}

/// A list of words, or one word for a set.
impl<'de> Deserialize<'de> for Excitation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Words {
            One(String),
            List(Vec<String>),
        }
        let unknown = |word: &str| {
            serde::de::Error::custom(format!(
                "\"{word}\" is unknown; must be collisions, force, friction or both, or a list of collisions, force, friction"
            ))
        };
        match Words::deserialize(deserializer)? {
            Words::One(word) => {
                let known = Self::WORDS.iter().find(|(known, _)| *known == word);
                known.map(|(_, set)| *set).ok_or_else(|| unknown(&word))
            }
            Words::List(words) => words.iter().try_fold(Self::NONE, |set, word| {
                let known = Exciter::ALL.iter().find(|(known, _)| known == word);
                known.map(|(_, exciter)| set.with(*exciter)).ok_or_else(|| unknown(word))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_survives_the_way_through_text_and_the_old_words_stay() {
        let all = Excitation::BOTH.with(Exciter::Friction);
        for set in [Excitation::NONE, Excitation::COLLISIONS, Excitation::FORCE, Excitation::BOTH, all] {
            let text = serde_json::to_string(&set).unwrap();
            assert_eq!(serde_json::from_str::<Excitation>(&text).unwrap(), set, "{text}");
        }
        for (word, set) in Excitation::WORDS {
            assert_eq!(serde_json::from_str::<Excitation>(&format!("\"{word}\"")).unwrap(), set);
        }
        let error = serde_json::from_str::<Excitation>("[\"collisions\", \"magic\"]").unwrap_err();
        assert!(error.to_string().contains("\"magic\" is unknown"), "{error}");
    }
}
