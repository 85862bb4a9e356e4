//! Measuring tools of tests, benches and examples. No program is made of it: a crate takes it as a
//! dev-dependency.
//!
//! It is a crate because a Fourier transform or a matrix of any size is compiled anew, half a
//! minute each, in every test program that calls the generic code behind it. So nothing here is
//! generic: whoever calls it links it.
//!
//! | module | measures or makes |
//! |---|---|
//! | [`spectrum`] | power and third octaves of a signal, its strongest line |
//! | [`coloured_noise`] | stationary noise of any colour |
//! | [`impact`] | struck bodies of known modes |
//! | [`corpus`] | where recorded and drawn inputs lie |
//! | [`cramer_rao`] | how well their modes can be known at all |
//! | [`score`] | modes that were found against those that are there |
//! | [`stft_peaks`] | the baseline: modes as peaks of a short-time spectrum |
//! | [`exact_brownian`] | surfaces of known fractal dimension |
//! | [`process`] | time and memory that this process took |

pub mod coloured_noise;
pub mod corpus;
pub mod cramer_rao;
pub mod exact_brownian;
pub mod impact;
pub mod process;
pub mod score;
pub mod spectrum;
pub mod stft_peaks;
