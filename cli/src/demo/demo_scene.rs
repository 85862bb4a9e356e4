//! A scene of the demo: its files, and the words beside them.

use asperity::files::contact_log::ContactLog;

/// A file of the demo: name and content.
pub type Asset = (String, Vec<u8>);

/// One scene: its page in the index and its files.
#[derive(Debug, Clone)]
pub struct DemoScene {
    /// File stem.
    pub name: &'static str,
    /// Headline.
    pub title: &'static str,
    /// Hints on what to listen to and look at.
    pub notice: &'static str,
    /// `NAME.toml`.
    pub toml: String,
    /// `NAME.jsonl`.
    pub log: ContactLog,
    /// Maps and modes that belong to this scene alone.
    pub assets: Vec<Asset>,
}
