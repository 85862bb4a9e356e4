//! Draws: random numbers that belong to a stroke and a field, not to an order.
//!
//! ```text
//! x = Philox₄ₓ₃₂₋₁₀(counter = (stroke, field), key = seed)
//! ```
//! A counter-based generator (J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw: "Parallel random
//! numbers: as easy as 1, 2, 3", SC 2011) has no state: a number is a function of seed, stroke and
//! the field's name. A stroke is therefore the same whatever the size of shards, their order and
//! who makes them, and a new field changes no other.

/// Multipliers of the rounds (Salmon et al. 2011, section 3.3).
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Growth of the key by each round: the golden ratio and √3 − 1.
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// Source of draws: a specification's seed and a stroke's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Seed of the whole data set.
    pub seed: u64,
    /// Number of the stroke, from 0.
    pub stroke: u64,
}

impl Draws {
    /// 128 random bits of a field; `attempt` counts further ones for the same field.
    #[must_use]
    pub fn bits(self, field: &str, attempt: u32) -> [u64; 2] {
        let field = fnv(field, attempt);
        let counter = [low(self.stroke), high(self.stroke), low(field), high(field)];
        let [a, b, c, d] = philox(counter, [low(self.seed), high(self.seed)]).map(u64::from);
        [a | b << 32, c | d << 32]
    }

    /// Two numbers in [0, 1), of 53 bits each.
    #[must_use]
    pub fn pair(self, field: &str, attempt: u32) -> [f64; 2] {
        self.bits(field, attempt).map(|bits| (bits >> 11) as f64 * 2.0_f64.powi(-53))
    }

    /// A number in [0, 1).
    #[must_use]
    pub fn unit(self, field: &str) -> f64 {
        self.pair(field, 0)[0]
    }

    /// One of `count` places, each as likely.
    #[must_use]
    pub fn place(self, field: &str, count: usize) -> usize {
        ((self.unit(field) * count as f64) as usize).min(count.saturating_sub(1))
    }
}

fn low(bits: u64) -> u32 {
    bits as u32
}

fn high(bits: u64) -> u32 {
    (bits >> 32) as u32
}

/// The name of a field as 64 bits (FNV-1a).
fn fnv(field: &str, attempt: u32) -> u64 {
    let bytes = field.bytes().chain(attempt.to_le_bytes());
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let [a, b] = [
            u64::from(MULTIPLIERS[0]) * u64::from(counter[0]),
            u64::from(MULTIPLIERS[1]) * u64::from(counter[2]),
        ];
        counter = [high(b) ^ counter[1] ^ key[0], low(b), high(a) ^ counter[3] ^ key[1], low(a)];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers of the authors' own library (Random123 1.14, `kat_vectors`).
    #[test]
    fn the_generator_gives_the_known_answers_of_its_authors() {
        for (counter, key, answer) in [
            ([0; 4], [0; 2], [0x6627_E8D5, 0xE169_C58D, 0xBC57_AC4C, 0x9B00_DBD8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408F_276D, 0x41C8_3B0E, 0xA20B_C7C6, 0x6D54_51FD]),
            (
                [0x243F_6A88, 0x85A3_08D3, 0x1319_8A2E, 0x0370_7344],
                [0xA409_3822, 0x299F_31D0],
                [0xD16C_FE09, 0x94FD_CCEB, 0x5001_E420, 0x2412_6EA1],
            ),
        ] {
            assert_eq!(philox(counter, key), answer);
        }
    }

    #[test]
    fn numbers_are_even_and_fields_and_strokes_are_unlike() {
        let of = |field: &str| -> Vec<f64> {
            (0..20_000).map(|stroke| Draws { seed: 7, stroke }.unit(field)).collect()
        };
        let (speeds, forces) = (of("finger.speed_m_s"), of("finger.force_n"));
        for numbers in [&speeds, &forces] {
            let mean = numbers.iter().sum::<f64>() / 2e4;
            let square = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2e4;
            // Three standard errors of mean and variance of an even distribution.
            assert!((mean - 0.5).abs() < 0.0062 && (square - 1.0 / 12.0).abs() < 0.0016, "{mean} {square}");
        }
        let product: f64 = speeds.iter().zip(&forces).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum();
        assert!((product / 2e4 * 12.0).abs() < 0.021, "{product}");
    }

    #[test]
    fn a_place_is_never_past_the_last() {
        for stroke in 0..1000 {
            assert!(Draws { seed: 1, stroke }.place("x", 3) < 3);
        }
    }
}
