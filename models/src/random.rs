//! Random draws as a function of (seed, stream, index): any draw can be repeated alone, and a new
//! stream changes no other.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Uniform in [0, 1): draw `index` of a named stream.
pub fn uniform(seed: u64, stream: &str, index: u64) -> f64 {
    to_unit(generator(seed, stream, index).next_u64())
}

/// The draws `uniform` gives for 0, 1, 2 …, in one go: many times cheaper than one by one.
pub fn uniforms(seed: u64, stream: &str) -> impl Iterator<Item = f64> + use<> {
    let mut generator = generator(seed, stream, 0);
    std::iter::repeat_with(move || {
        let draw = to_unit(generator.next_u64());
        // The rest of the words set aside.
        generator.next_u64();
        draw
    })
}

/// Standard normal: draw `index` of a named stream (Box and Muller 1958).
pub fn normal(seed: u64, stream: &str, index: u64) -> f64 {
    box_muller(&mut generator(seed, stream, index))
}

fn box_muller(generator: &mut ChaCha8Rng) -> f64 {
    // 1 - u lies in (0, 1]: its logarithm is finite.
    let radius = (-2.0 * libm::log(1.0 - to_unit(generator.next_u64()))).sqrt();
    radius * libm::cos(std::f64::consts::TAU * to_unit(generator.next_u64()))
}

/// The draws `normal` gives for indices that come in order, many times cheaper: those of one block of the
/// generator are made at once. What it holds is a function of seed, stream and index, and no state.
#[derive(Clone, Debug, Default)]
pub struct Normals {
    drawn: Option<(u64, u64, &'static str)>,
    draws: [f64; Self::BLOCK as usize],
}

impl PartialEq for Normals {
    /// Always: what they give depends on what is asked for alone.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Normals {
    /// Draws in the words that the generator makes at a time.
    const BLOCK: u64 = 16;

    /// As [`normal`].
    pub fn at(&mut self, seed: u64, stream: &'static str, index: u64) -> f64 {
        let block = index / Self::BLOCK;
        if self.drawn != Some((block, seed, stream)) {
            self.drawn = Some((block, seed, stream));
            let mut generator = generator(seed, stream, block * Self::BLOCK);
            self.draws.fill_with(|| box_muller(&mut generator));
        }
        self.draws[(index % Self::BLOCK) as usize]
    }
}

/// Three independent standard normals.
pub fn normal3(seed: u64, stream: &str, index: u64) -> nalgebra::Vector3<f64> {
    nalgebra::Vector3::from_fn(|axis, _| normal(seed, stream, 3 * index + axis as u64))
}

/// The generator at the place of one draw: a stream is one sequence of ChaCha8 of its own.
fn generator(seed: u64, stream: &str, index: u64) -> ChaCha8Rng {
    /// 32-bit words set aside for one draw.
    const WORDS: u128 = 4;
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(fnv1a(stream));
    generator.set_word_pos(WORDS * u128::from(index));
    generator
}

/// The 53 leading bits as a fraction.
fn to_unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// FNV-1a, 64 bits.
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_repeatable_and_streams_and_seeds_differ() {
        assert_eq!(normal(7, "thrust", 3), normal(7, "thrust", 3));
        assert_ne!(normal(7, "thrust", 3), normal(7, "thrust", 4));
        assert_ne!(normal(7, "thrust", 3), normal(7, "gimbal", 3));
        assert_ne!(normal(7, "thrust", 3), normal(8, "thrust", 3));
    }

    #[test]
    fn a_whole_stream_gives_the_same_draws() {
        let drawn = uniforms(7, "rocks").zip(0..).take(100);
        assert!(drawn.into_iter().all(|(draw, index)| draw == uniform(7, "rocks", index)));
    }

    #[test]
    fn draws_in_blocks_are_the_same_draws() {
        let mut normals = Normals::default();
        for (seed, index) in
            (0..100).map(|index| (7, index)).chain([(7, 5), (8, 5), (8, 6), (7, 40)])
        {
            assert_eq!(normals.at(seed, "thrust", index), normal(seed, "thrust", index));
        }
    }

    #[test]
    fn normals_have_the_moments_of_a_normal() {
        let n = 20_000_u64;
        let draws: Vec<f64> = (0..n).map(|index| normal(1, "moments", index)).collect();
        let moment = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / n as f64;
        // Five standard errors of each sample moment: sqrt(Var(x^p) / n) = sqrt((1, 2, 96) / n).
        for (power, expected, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (4, 3.0, 96.0)] {
            let bound = 5.0 * (variance / n as f64).sqrt();
            assert!((moment(power) - expected).abs() < bound, "moment {power}: {}", moment(power));
        }
    }
}
