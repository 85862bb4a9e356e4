//! Body: what the engine will play, held against the recording.
//!
//! | file | from → to |
//! |---|---|
//! | [`fitted`] | partials → modes with standard deviations, and figures of them |
//! | `struck` | partials → the samples that the engine plays |
//! | `last_solve` | poles → amplitudes and phases that leave least of the recording and are no louder |
//! | [`residual`] | recording and struck body → what no mode explains |

pub mod fitted;
mod last_solve;
pub mod residual;
mod struck;
