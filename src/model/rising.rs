//! Order of numbers.

/// Places of `numbers` from the least to the greatest, equal ones as they stand.
pub(crate) fn rising(numbers: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by(|a, b| numbers[*a].total_cmp(&numbers[*b]));
    order
}
