//! Body: what the engine will play, held against the recording.
//!
//! | file | from → to |
//! |---|---|
//! | [`fitted`] | partials → modes with standard deviations, and figures of them |
//! | `struck` | partials → the samples that the engine plays |
//! | `no_louder` | modes louder than their recording → modes that are not |
//! | [`residual`] | recording and struck body → what no mode explains |

pub mod fitted;
mod no_louder;
pub mod residual;
mod struck;
