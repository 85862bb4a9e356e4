//! Body: what the engine will play, held against the recording.
//!
//! | file | from → to |
//! |---|---|
//! | [`fitted`] | partials → modes with standard deviations, and figures of them |
//! | `solved` | partials → those that are known, with the amplitudes that are played |
//! | `struck` | partials → the samples that the engine plays |
//! | `last_solve` | poles → amplitudes and phases that leave least of the recording and are no louder |
//! | `diffuse` | recording and struck body → bands of noise for what no mode explains |
//! | [`residual`] | recording and struck body → what no mode explains |

mod diffuse;
pub mod fitted;
mod last_solve;
pub mod residual;
mod solved;
mod struck;
