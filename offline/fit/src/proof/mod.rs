//! Proof: which partials the data need, which of them ring, and what a user should know of the
//! others.
//!
//! | file | from → to |
//! |---|---|
//! | `known_decay` | modes whose decay the sound does not show → fewer, none of which rings longer than it supports |
//! | `late_support` | modes → those that the recording does not have later |
//! | `pruning` | partials → proven partials with standard deviations |
//! | `ringing` | segment → is there anything but noise; partials → which stand out of steep noise |
//! | `suspicion` | partials → hum, no decay, not exponential |
//! | `rumble` | partials → those from the lowest partial of the body on |
//! | [`warning`] | what is said of all this |

pub(crate) mod known_decay;
pub(crate) mod late_support;
pub(crate) mod pruning;
pub(crate) mod ringing;
pub(crate) mod rumble;
pub(crate) mod suspicion;
pub mod warning;
