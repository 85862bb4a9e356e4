//! Evidence: what asperity's figures are measured and judged with. Tests, benches and examples take
//! it as a dev-dependency; the program takes the judges.
//!
//! It is a crate because a Fourier transform or a matrix of any size is compiled anew, half a
//! minute each, in every test program that calls the generic code behind it. So nothing here is
//! generic: the caller links it. The observer and the engine do not call each other.
//!
//! | module | measures, makes or judges |
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
//! | [`reliefs`] | the six reliefs of the thesis' first experiment |
//! | [`statistics`] | answers that people give: shares, means, d′, thresholds |
//! | [`observer`] | the frozen observer: plates told apart with a person's noise |
//! | `sources` | figures and tables of the sources, computed again (feature `judges`) |
//! | `abx`, `compare`, `likeness`, `plates` | surfaces told apart, and ordered, by strokes through the engine (feature `judges`) |
//! | `abrasive`, `growth` | what a tool feels of coated abrasives, and how what is felt grows with speed and force (feature `judges`) |

#[cfg(feature = "judges")]
pub mod abrasive;
#[cfg(feature = "judges")]
pub mod abx;
pub mod coloured_noise;
#[cfg(feature = "judges")]
pub mod compare;
pub mod corpus;
pub mod cramer_rao;
pub mod exact_brownian;
#[cfg(feature = "judges")]
pub mod growth;
pub mod impact;
#[cfg(feature = "judges")]
pub mod likeness;
pub mod observer;
#[cfg(feature = "judges")]
pub mod plates;
pub mod process;
pub mod reliefs;
pub mod score;
#[cfg(feature = "judges")]
pub mod sources;
pub mod spectrum;
pub mod statistics;
pub mod stft_peaks;
