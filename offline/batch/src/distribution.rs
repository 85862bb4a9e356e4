//! Distributions: what stands in a specification instead of a value.
//!
//! | written | drawn |
//! |---|---|
//! | `{ uniform = [a, b] }` | evenly between a and b |
//! | `{ log_uniform = [a, b] }` | evenly between log a and log b |
//! | `{ normal = [mean, sd] }`, with `within = [a, b]` | normally; drawn again while outside |
//! | `{ choice = [x, y, …] }` | one of them, each as likely; they may be distributions themselves |
//!
//! Anything else is itself.

use crate::draw::Draws;
use asperity::files::FileError;
use toml::{Table, Value};

/// A normal draw outside `within` is repeated at most this often; a range that so many miss is
/// refused.
const ATTEMPTS: u32 = 1000;

/// The value of a field for one stroke: `written`, with what is a distribution drawn, however deep.
///
/// # Errors
/// When a distribution is not written as the table above says; the message names the field.
pub fn drawn(written: &Value, field: &str, draws: Draws) -> Result<Value, FileError> {
    match written {
        Value::Table(table) => match Kind::of(table, field)? {
            Some(kind) => kind.draw(field, draws),
            None => Ok(Value::Table(drawn_table(table, field, draws)?)),
        },
        Value::Array(values) => {
            let each =
                values.iter().enumerate().map(|(i, value)| drawn(value, &format!("{field}[{i}]"), draws));
            Ok(Value::Array(each.collect::<Result<_, _>>()?))
        }
        plain => Ok(plain.clone()),
    }
}

/// Draws every key of a table.
///
/// # Errors
/// As [`drawn`].
pub fn drawn_table(table: &Table, field: &str, draws: Draws) -> Result<Table, FileError> {
    let of =
        |(key, value): (&String, &Value)| Ok((key.clone(), drawn(value, &format!("{field}.{key}"), draws)?));
    table.iter().map(of).collect()
}

/// Every value that a field may be drawn as: both ends of ranges (of a normal one without `within`,
/// so many deviations from the mean), each value of choices; one at a time, the others at their
/// first.
///
/// # Errors
/// As [`drawn`].
pub fn ends(written: &Value, field: &str, deviations: f64) -> Result<Vec<Value>, FileError> {
    let numbers = |numbers: [f64; 2]| Ok(numbers.map(Value::Float).to_vec());
    match written {
        Value::Table(table) => match Kind::of(table, field)? {
            Some(Kind::Uniform(range) | Kind::LogUniform(range)) => numbers(range),
            Some(Kind::Normal { mean, deviation, within: [low, high] }) => {
                numbers([low.max(mean - deviations * deviation), high.min(mean + deviations * deviation)])
            }
            Some(Kind::Choice(values)) => {
                let each = values.iter().zip(1..);
                let each = each.map(|(value, i)| ends(value, &format!("{field}.choice {i}"), deviations));
                Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
            }
            None => Ok(ends_of_table(table, field, deviations)?.into_iter().map(Value::Table).collect()),
        },
        Value::Array(values) => {
            let each = values.iter().map(|value| ends(value, field, deviations));
            let each = each.collect::<Result<Vec<_>, _>>()?;
            Ok(one_at_a_time(&each).into_iter().map(Value::Array).collect())
        }
        plain => Ok(vec![plain.clone()]),
    }
}

/// [`ends`] of every key of a table.
///
/// # Errors
/// As [`drawn`].
pub fn ends_of_table(table: &Table, field: &str, deviations: f64) -> Result<Vec<Table>, FileError> {
    let of = |(key, value): (&String, &Value)| ends(value, &format!("{field}.{key}"), deviations);
    let each = table.iter().map(of).collect::<Result<Vec<_>, _>>()?;
    let with = |values: Vec<Value>| table.keys().cloned().zip(values).collect();
    Ok(one_at_a_time(&each).into_iter().map(with).collect())
}

/// Lists in which one entry at a time is another than its first.
fn one_at_a_time(each: &[Vec<Value>]) -> Vec<Vec<Value>> {
    let first: Vec<Value> = each.iter().filter_map(|values| values.first().cloned()).collect();
    let mut all = vec![first.clone()];
    for (place, values) in each.iter().enumerate() {
        for value in values.iter().skip(1) {
            let mut other = first.clone();
            other[place] = value.clone();
            all.push(other);
        }
    }
    all
}

enum Kind<'a> {
    Uniform([f64; 2]),
    LogUniform([f64; 2]),
    Normal { mean: f64, deviation: f64, within: [f64; 2] },
    Choice(&'a [Value]),
}

impl<'a> Kind<'a> {
    /// Which distribution a table is; none where it is a table of the scene.
    fn of(table: &'a Table, field: &str) -> Result<Option<Self>, FileError> {
        let names = ["uniform", "log_uniform", "normal", "choice"];
        let Some(name) = names.into_iter().find(|name| table.contains_key(*name)) else { return Ok(None) };
        let other = table.keys().find(|key| *key != name && !(name == "normal" && *key == "within"));
        if let Some(other) = other {
            let right = format!("a distribution is {} alone, normal with within", names.join(", "));
            return Err(FileError::new(format!("{field}.{other}"), format!("stands beside {name}"), right));
        }
        let of = &table[name];
        let kind = match name {
            "uniform" => Self::Uniform(ordered(of, &format!("{field}.uniform"))?),
            "log_uniform" => Self::LogUniform(positive(of, &format!("{field}.log_uniform"))?),
            "normal" => {
                let [mean, deviation] = two(of, &format!("{field}.normal"))?;
                if deviation < 0.0 {
                    let right = "a deviation of 0 or more, [mean, deviation]";
                    return Err(FileError::new(
                        format!("{field}.normal"),
                        format!("{deviation} is refused"),
                        right,
                    ));
                }
                let within = table.get("within").map(|value| ordered(value, &format!("{field}.within")));
                let within = within.transpose()?.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                Self::Normal { mean, deviation, within }
            }
            _ => match of.as_array() {
                Some(values) if !values.is_empty() => Self::Choice(values),
                _ => {
                    return Err(FileError::new(
                        format!("{field}.choice"),
                        "is no list of values",
                        "write choice = [\"a\", \"b\"]",
                    ));
                }
            },
        };
        Ok(Some(kind))
    }

    fn draw(&self, field: &str, draws: Draws) -> Result<Value, FileError> {
        let x = draws.unit(field);
        let number = match *self {
            Self::Uniform([a, b]) => (a + x * (b - a)).clamp(a, b),
            Self::LogUniform([a, b]) => (a * libm::exp(x * libm::log(b / a))).clamp(a, b),
            Self::Normal { mean, deviation, within: [a, b] } => (0..ATTEMPTS)
                .map(|attempt| mean + deviation * normal(draws.pair(field, attempt)))
                .find(|x| (a..=b).contains(x))
                .ok_or_else(|| {
                    let right = "a range that a normal draw meets more often than once in a thousand";
                    FileError::new(format!("{field}.within"), format!("[{a}, {b}] is hardly ever met"), right)
                })?,
            Self::Choice(values) => {
                let place = draws.place(field, values.len());
                return drawn(&values[place], &format!("{field}.{place}"), draws);
            }
        };
        Ok(Value::Float(number))
    }
}

/// Box and Muller's transform of two even numbers.
fn normal([a, b]: [f64; 2]) -> f64 {
    // 1 − a is above 0.
    libm::sqrt(-2.0 * libm::log(1.0 - a)) * libm::cos(std::f64::consts::TAU * b)
}

fn two(value: &Value, field: &str) -> Result<[f64; 2], FileError> {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    match value.as_array().map(Vec::as_slice) {
        Some([a, b]) => match (number(a), number(b)) {
            (Some(a), Some(b)) if a.is_finite() && b.is_finite() => Ok([a, b]),
            _ => Err(FileError::new(field, "holds no two finite numbers", "write [a, b]")),
        },
        _ => Err(FileError::new(field, "is no pair of numbers", "write [a, b]")),
    }
}

fn ordered(value: &Value, field: &str) -> Result<[f64; 2], FileError> {
    let [a, b] = two(value, field)?;
    if a <= b {
        Ok([a, b])
    } else {
        Err(FileError::new(field, format!("[{a}, {b}] is refused"), "the lower number comes first"))
    }
}

fn positive(value: &Value, field: &str) -> Result<[f64; 2], FileError> {
    let [a, b] = ordered(value, field)?;
    if a > 0.0 {
        Ok([a, b])
    } else {
        Err(FileError::new(field, format!("{a} is refused"), "both must be above 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Value {
        format!("x = {text}").parse::<Table>().unwrap().remove("x").unwrap()
    }

    fn many(text: &str) -> Vec<f64> {
        let written = value(text);
        let of = |stroke| drawn(&written, "x", Draws { seed: 3, stroke }).unwrap().as_float().unwrap();
        (0..20_000).map(of).collect()
    }

    fn moments(numbers: &[f64]) -> (f64, f64) {
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        let square = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / numbers.len() as f64;
        (mean, square.sqrt())
    }

    #[test]
    fn distributions_have_their_means_and_deviations() {
        let (mean, deviation) = moments(&many("{ uniform = [2, 4] }"));
        assert!(
            (mean - 3.0).abs() < 0.013 && (deviation - 2.0 / 12f64.sqrt()).abs() < 0.01,
            "{mean} {deviation}"
        );
        let (mean, deviation) = moments(&many("{ normal = [0.6, 0.2] }"));
        assert!((mean - 0.6).abs() < 0.005 && (deviation - 0.2).abs() < 0.004, "{mean} {deviation}");
        // The mean of a log-uniform number is (b − a)/ln(b/a).
        let (mean, _) = moments(&many("{ log_uniform = [1e-4, 4e-3] }"));
        assert!((mean / (3.9e-3 / 40f64.ln()) - 1.0).abs() < 0.03, "{mean}");
        let cut = many("{ normal = [0.6, 0.2], within = [0.5, 0.7] }");
        assert!(cut.iter().all(|x| (0.5..=0.7).contains(x)));
    }

    #[test]
    fn choices_hold_values_tables_and_distributions() {
        let written =
            value("{ choice = [\"pen\", { solid = \"granite\", magnitude = { uniform = [1, 2] } }, 3] }");
        let mut seen = [0; 3];
        for stroke in 0..3000 {
            match drawn(&written, "x", Draws { seed: 5, stroke }).unwrap() {
                Value::String(_) => seen[0] += 1,
                Value::Table(table) => {
                    assert!((1.0..=2.0).contains(&table["magnitude"].as_float().unwrap()));
                    seen[1] += 1;
                }
                other => {
                    assert_eq!(other, Value::Integer(3));
                    seen[2] += 1;
                }
            }
        }
        assert!(seen.iter().all(|n| (900..1100).contains(n)), "{seen:?}");
    }

    #[test]
    fn a_wrong_distribution_is_refused_with_its_field() {
        for (text, part) in [
            ("{ uniform = [4, 2] }", "x.uniform: [4, 2] is refused"),
            ("{ uniform = 4 }", "x.uniform: is no pair"),
            ("{ log_uniform = [0, 2] }", "x.log_uniform: 0 is refused"),
            ("{ normal = [1, -1] }", "x.normal: -1 is refused"),
            ("{ normal = [0, 1], within = [50, 60] }", "x.within: [50, 60] is hardly ever met"),
            ("{ choice = [] }", "x.choice: is no list"),
            ("{ uniform = [1, 2], within = [1, 2] }", "x.within: stands beside uniform"),
            ("[{ uniform = [1, nan] }]", "x[0].uniform: holds no two finite"),
        ] {
            let error = drawn(&value(text), "x", Draws { seed: 0, stroke: 0 }).unwrap_err().to_string();
            assert!(error.starts_with(part), "{error}");
        }
    }
}
