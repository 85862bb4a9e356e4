//! Track: a parameter over time, from curves and single values, each of which acts from its own
//! beginning on.

/// Curves in the order in which they were read.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    curves: Vec<Vec<(f64, f64)>>,
}

/// Points in time order, straight between; equal times are a jump.
#[derive(Debug)]
pub(crate) struct Points {
    points: Vec<(f64, f64)>,
    default: f64,
}

impl Track {
    /// A curve, or a single value.
    pub(crate) fn put(&mut self, mut points: Vec<(f64, f64)>) {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if !points.is_empty() {
            self.curves.push(points);
        }
    }

    pub(crate) fn append(&mut self, mut other: Self) {
        self.curves.append(&mut other.curves);
    }

    /// All of it as points; `default` before the first.
    pub(crate) fn points(&self, default: f64) -> Points {
        let mut curves = self.curves.clone();
        curves.sort_by(|a, b| a[0].0.total_cmp(&b[0].0));
        let mut made = Points { points: Vec::new(), default };
        for curve in curves {
            let (begins_s, first) = curve[0];
            // To the rounding of times that count from a curve's own beginning.
            let before = made.at(begins_s, false);
            let kept = made.points.partition_point(|p| p.0 < begins_s - 1e-9);
            made.points.truncate(kept);
            if begins_s > 1e-9 && (before - first).abs() > 1e-9 {
                made.points.push((begins_s, before));
            }
            made.points.extend(curve);
        }
        made
    }
}

impl Points {
    /// Times at which it bends, s.
    pub(crate) fn times_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|p| p.0)
    }

    /// Times at which it crosses a level on its way, s.
    pub(crate) fn crossings_s(&self, level: f64) -> impl Iterator<Item = f64> + '_ {
        self.points.windows(2).filter_map(move |w| {
            let (from, to) = (w[0].1 - level, w[1].1 - level);
            (from * to < 0.0).then(|| w[0].0 + from / (from - to) * (w[1].0 - w[0].0))
        })
    }

    /// Its value at a time; at a jump that before it or behind it.
    pub(crate) fn at(&self, time_s: f64, behind: bool) -> f64 {
        let is_past = |p: &(f64, f64)| if behind { p.0 <= time_s + 1e-9 } else { p.0 < time_s - 1e-9 };
        let next = self.points.partition_point(is_past);
        match (next.checked_sub(1).map(|i| self.points[i]), self.points.get(next)) {
            (None, Some(first)) if first.0 <= time_s + 1e-9 => first.1,
            (None, _) => self.default,
            (Some(last), None) => last.1,
            (Some(a), Some(b)) if b.0 > a.0 => {
                a.1 + ((time_s - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) * (b.1 - a.1)
            }
            (Some(a), Some(_)) => a.1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_curve_acts_from_its_beginning_and_holds_its_end() {
        let mut track = Track::default();
        track.put(vec![(1.0, 0.2), (2.0, 0.4)]);
        track.put(vec![(3.0, 0.5)]);
        let points = track.points(1.0);
        for (time_s, behind, value) in [
            (0.0, true, 1.0),
            (0.99, true, 1.0),
            (1.0, false, 1.0),
            (1.0, true, 0.2),
            (1.5, true, 0.3),
            (2.5, true, 0.4),
            (3.0, false, 0.4),
            (3.0, true, 0.5),
            (9.0, true, 0.5),
        ] {
            assert!((points.at(time_s, behind) - value).abs() < 1e-12, "{time_s} {behind}");
        }
    }
}
