//! Body: what the engine will play, held against the recording.
//!
//! | file | from → to |
//! |---|---|
//! | [`fitted`] | partials → modes with standard deviations, and figures of them |
//! | `struck` | partials → the samples that the engine plays |
//! | [`residual`] | recording and struck body → what no mode explains |

pub mod fitted;
pub mod residual;
mod struck;
