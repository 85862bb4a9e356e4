//! Removes the terraces of an 8-bit map where the map is gentle enough for them to be felt.
