//! The tests of data sets in one program, but for the one that measures its cost.

mod shards;
