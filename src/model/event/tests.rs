use super::*;

fn sample() -> ContactSample {
    ContactSample { uv: [0.1, 0.2], velocity_m_s: Some([0.1, 0.0]), normal_force_n: 0.5, closing_m_s: 0.0 }
}

#[test]
fn an_ordinary_sample_is_accepted_unchanged() {
    assert_eq!(sample().checked(), Ok(sample()));
}

#[test]
fn a_negative_force_counts_as_none() {
    let lifting = ContactSample { normal_force_n: -0.01, ..sample() };
    assert_eq!(lifting.checked().unwrap().normal_force_n, 0.0);
}

#[test]
fn numbers_that_no_contact_has_are_refused_by_name() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let cases = [
            ("uv", ContactSample { uv: [0.0, bad], ..sample() }),
            ("velocity_m_s", ContactSample { velocity_m_s: Some([bad, 0.0]), ..sample() }),
            ("normal_force_n", ContactSample { normal_force_n: bad, ..sample() }),
            ("closing_m_s", ContactSample { closing_m_s: bad, ..sample() }),
        ];
        for (field, case) in cases {
            assert_eq!(case.checked().unwrap_err().field, field);
        }
    }
}
