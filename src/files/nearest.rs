//! Nearest word: which of the words that would be right was meant by one that is not.

/// Other names that files of this kind are often written with, and the word that was meant.
const SYNONYMS: [(&str, &str); 28] = [
    ("time", "t"),
    ("times", "t"),
    ("timestamp", "t"),
    ("ts", "t"),
    ("type", "event"),
    ("kind", "event"),
    ("id", "contact"),
    ("finger", "contact"),
    ("force", "normal_force_n"),
    ("pressure", "normal_force_n"),
    ("pos", "uv"),
    ("position", "uv"),
    ("speed", "velocity_m_s"),
    ("vel", "velocity_m_s"),
    ("depth", "depth_m"),
    ("mesh", "body"),
    ("object", "body"),
    ("material", "striker"),
    ("tool", "probe"),
    ("start", "begin"),
    ("down", "begin"),
    ("touch", "begin"),
    ("update", "move"),
    ("stop", "end"),
    ("up", "end"),
    ("release", "end"),
    ("hit", "impact"),
    ("strike", "impact"),
];

/// The word among `known` that was meant by `word`: the same in another case, another name for it,
/// one that begins like it or holds it, or one that is a slip or two away. `None` where nothing is
/// near.
#[must_use]
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let plain = |word: &str| word.to_ascii_lowercase().replace(['-', ' ', '_'], "");
    let meant = plain(word);
    if let Some(same) = known.iter().find(|known| plain(known) == meant) {
        return Some(same);
    }
    let other = SYNONYMS.iter().find(|(name, of)| *name == meant && known.contains(of));
    if let Some((_, name)) = other {
        return known.iter().copied().find(|known| known == name);
    }
    if meant.chars().count() < 3 {
        return None;
    }
    let begins = |known: &str| known.len() > 2 && (known.starts_with(&*meant) || meant.starts_with(known));
    let alike = known.iter().find(|known| begins(&plain(known)));
    let slips = |known: &&&str| distance(&meant, &plain(known));
    let near = || {
        let nearest = known.iter().min_by_key(slips)?;
        (slips(&nearest) <= meant.chars().count() / 4 + usize::from(meant.len() < 8)).then_some(nearest)
    };
    let holds = || known.iter().find(|known| meant.len() > 3 && plain(known).contains(&*meant));
    alike.or_else(near).or_else(holds).copied()
}

/// Number of letters that have to be put in, left out, changed or swapped with the next.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let changed = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = changed.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

/// The first number behind a colon or an equals sign that is written with a decimal comma, as it
/// would be right: `0.59` of `gain = 0,59`.
#[must_use]
pub fn decimal_comma(line: &str) -> Option<String> {
    line.match_indices([':', '=']).find_map(|(place, _)| {
        let value = line[place + 1..].trim_start();
        let end = value.find(|c: char| !c.is_ascii_digit() && !"+-,.".contains(c)).unwrap_or(value.len());
        let (whole, part) = value[..end].split_once(',')?;
        let part = part.split(',').next().unwrap_or_default();
        let digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
        (digits(whole.trim_start_matches(['+', '-'])) && digits(part)).then(|| format!("{whole}.{part}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_word_and_a_stranger_none() {
        let keys = ["t", "event", "contact", "surface", "uv", "velocity_m_s", "normal_force_n", "gain"];
        for (slip, meant) in [
            ("Event", "event"),
            ("evnet", "event"),
            ("time", "t"),
            ("UV", "uv"),
            ("velocity", "velocity_m_s"),
            ("velocityMS", "velocity_m_s"),
            ("velocty_m_s", "velocity_m_s"),
            ("force", "normal_force_n"),
            ("normal_force", "normal_force_n"),
            ("normalforce_N", "normal_force_n"),
            ("id", "contact"),
            ("contct", "contact"),
            ("gian", "gain"),
        ] {
            assert_eq!(nearest(slip, &keys), Some(meant), "{slip}");
        }
        for stranger in ["colour", "x", "brightness", "", "é"] {
            assert_eq!(nearest(stranger, &keys), None, "{stranger}");
        }
        assert_eq!(nearest("unifrom", &["uniform", "log_uniform", "normal"]), Some("uniform"));
    }

    #[test]
    fn the_distance_is_that_of_the_textbook() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("ca", "abc"), 3);
        assert_eq!(distance("unifrom", "uniform"), 1);
        assert_eq!(distance("", "abc"), 3);
    }

    #[test]
    fn a_number_with_a_decimal_comma_is_read_as_it_was_meant() {
        assert_eq!(decimal_comma("gain = 0,59").as_deref(), Some("0.59"));
        assert_eq!(decimal_comma("{\"t\":-1,5,\"contact\":3}").as_deref(), Some("-1.5"));
        for right in ["{\"t\":1,\"uv\":[0.1,0.2]}", "size = [1,2]", "name = \"a,b\"", "a = 1.5, b = 2"] {
            assert_eq!(decimal_comma(right), None, "{right}");
        }
    }
}
