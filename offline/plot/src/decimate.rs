//! Long signals as short paths: the smallest and largest value of every pixel column.

use super::Series;
use std::ops::Range;

/// A polyline in panel coordinates, cut at gaps. `x` and `y` map values to pixels; nothing outside
/// `columns` (pixels) is kept, except one point on either side so that lines reach the edges.
pub fn polylines(
    data: &Series,
    x: impl Fn(f64) -> f64,
    y: impl Fn(f64) -> f64,
    columns: Range<f64>,
) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Lines::default();
    match data {
        Series::Uniform { start, step, y: values } => {
            let at = |index: usize| x(start + index as f64 * step);
            let visible = visible(values.len(), &at, &columns);
            let per_pixel = samples_per_pixel(&at, &visible);
            if per_pixel <= 3.0 {
                for index in visible {
                    lines.push([at(index), y(values[index])]);
                }
            } else {
                columns_of(values, &at, &y, visible, &mut lines);
            }
        }
        Series::Points(points) => {
            for point in points {
                lines.push([x(point[0]), y(point[1])]);
            }
        }
    }
    lines.finish()
}

#[derive(Default)]
struct Lines {
    done: Vec<Vec<[f64; 2]>>,
    open: Vec<[f64; 2]>,
}

impl Lines {
    fn push(&mut self, point: [f64; 2]) {
        if point[0].is_finite() && point[1].is_finite() {
            self.open.push(point);
        } else {
            self.cut();
        }
    }

    fn cut(&mut self) {
        if !self.open.is_empty() {
            self.done.push(std::mem::take(&mut self.open));
        }
    }

    fn finish(mut self) -> Vec<Vec<[f64; 2]>> {
        self.cut();
        self.done
    }
}

/// The indices inside the panel, and one more on either side.
fn visible(len: usize, at: &impl Fn(usize) -> f64, columns: &Range<f64>) -> Range<usize> {
    let first = partition(len, |index| at(index) < columns.start).saturating_sub(1);
    let last = partition(len, |index| at(index) <= columns.end);
    first..(last + 1).min(len)
}

/// Number of first indices for which `before` holds.
fn partition(len: usize, before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, len);
    while low < high {
        let middle = usize::midpoint(low, high);
        if before(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

fn samples_per_pixel(at: &impl Fn(usize) -> f64, visible: &Range<usize>) -> f64 {
    if visible.len() < 2 {
        return 1.0;
    }
    let pixels = (at(visible.end - 1) - at(visible.start)).abs();
    visible.len() as f64 / pixels.max(1.0)
}

/// In each pixel column, the two extremes in the order in which they came.
fn columns_of(
    values: &[f64],
    at: &impl Fn(usize) -> f64,
    y: &impl Fn(f64) -> f64,
    visible: Range<usize>,
    lines: &mut Lines,
) {
    let mut index = visible.start;
    while index < visible.end {
        let column = at(index).floor();
        let (mut low, mut high) = (index, index);
        let mut finite = values[index].is_finite();
        index += 1;
        while index < visible.end && at(index).floor() <= column {
            finite &= values[index].is_finite();
            if values[index] < values[low] {
                low = index;
            }
            if values[index] > values[high] {
                high = index;
            }
            index += 1;
        }
        if !finite {
            lines.cut();
            continue;
        }
        let middle = column + 0.5;
        lines.push([middle, y(values[low.min(high)])]);
        if low != high {
            lines.push([middle, y(values[low.max(high)])]);
        }
    }
}

/// The largest value of each pixel column, for stems: thousands of impulses stay a small file.
pub fn tallest(points: &[[f64; 2]], x: impl Fn(f64) -> f64, columns: Range<f64>) -> Vec<[f64; 2]> {
    let mut best: std::collections::BTreeMap<i64, f64> = std::collections::BTreeMap::new();
    for point in points {
        let at = x(point[0]);
        if !(at >= columns.start && at <= columns.end && point[1].is_finite()) {
            continue;
        }
        let slot = best.entry((at * 2.0).round() as i64).or_insert(point[1]);
        *slot = slot.max(point[1]);
    }
    best.into_iter().map(|(column, value)| [column as f64 / 2.0, value]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_click_in_a_million_samples_is_drawn() {
        let mut y = vec![0.0; 1_000_000];
        y[654_321] = 1.0;
        let series = Series::Uniform { start: 0.0, step: 1e-6, y };
        let lines = polylines(&series, |x| x * 800.0, |y| y, 0.0..800.0);
        let points: Vec<[f64; 2]> = lines.concat();
        assert!(points.len() < 2000);
        let click = points.iter().find(|point| point[1] == 1.0).unwrap();
        assert_eq!(click[0], 523.5);
    }

    #[test]
    fn a_gap_cuts_the_line() {
        let series = Series::Points(vec![[0.0, 0.0], [1.0, f64::NAN], [2.0, 0.0], [3.0, 0.0]]);
        let lines = polylines(&series, |x| x, |y| y, 0.0..10.0);
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn a_zoom_keeps_the_points_just_outside() {
        let series = Series::Uniform { start: 0.0, step: 1.0, y: vec![1.0; 100] };
        let lines = polylines(&series, |x| (x - 50.0) * 10.0, |y| y, 0.0..100.0);
        assert_eq!((lines[0][0][0], lines[0].last().unwrap()[0]), (-10.0, 110.0));
    }
}
