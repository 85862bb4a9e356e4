//! `Debug` of types that hold what cannot be printed: their name.

/// Implements `Debug` by name alone.
macro_rules! debug_by_name {
    ($($name:ty),* $(,)?) => {$(
        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($name)).finish_non_exhaustive()
            }
        }
    )*};
}
pub(crate) use debug_by_name;
