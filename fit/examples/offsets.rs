//! scratch
use asperity_fit::{ChannelChoice, contact::contact_samples, load, onset};
fn main() {
    for path in std::env::args().skip(1) {
        let r = load(&path, ChannelChoice::Loudest).unwrap();
        let mean = r.samples.iter().sum::<f64>() / r.samples.len() as f64;
        let s: Vec<f64> = r.samples.iter().map(|x| x - mean).collect();
        let strike = onset::find(&s, r.sample_rate_hz);
        let lead = &s[..strike.onset];
        let noise =
            if lead.len() > 200 { lead.iter().map(|x| x * x).sum::<f64>() / lead.len() as f64 } else { 0.0 };
        let c = contact_samples(&s[strike.onset..strike.end], r.sample_rate_hz, noise);
        println!(
            "{:40} onset {:.2} ms contact {:.2} ms others {:?}",
            r.name,
            1e3 * strike.onset as f64 / r.sample_rate_hz,
            1e3 * c as f64 / r.sample_rate_hz,
            strike.others.len()
        );
    }
}
