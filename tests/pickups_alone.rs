#[path = "common/closed_forms.rs"]
mod closed_forms;
mod pickups;
