//! A table of `from-photo` on pictures, one row each: `photo_table PHOTO[,DISPLACEMENT] … [--maps
//! DIR]`.
//!
//! With a displacement map (white is high) the correlation of the heights found and mapped, between
//! 4 texels and a quarter of the picture, says whether they are the right way up. `--maps` writes
//! displacement and roughness as 16-bit PNG.

use asperity_pictures::darkness_prior::high_pass;
use asperity_pictures::fft2::{Fft2, angular_frequency};
use asperity_pictures::from_photo::{MOST_TEXELS, PhotoOptions, PhotoSurface, surface_from_photo};
use asperity_pictures::photograph::load_reduced_photograph;
use asperity_surface::image_io::{Channel, load_channel, save_gray16};
use asperity_surface::raster::Raster;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let maps = arguments.iter().position(|a| a == "--maps").map(|at| {
        arguments.remove(at);
        PathBuf::from(arguments.remove(at))
    });
    println!(
        "picture method sign confidence r relief_mm micro_um R dimension noise_255 repeats seconds warnings"
    );
    for argument in &arguments {
        let (photo, displacement) =
            argument.split_once(',').map_or((argument.as_str(), None), |(p, d)| (p, Some(d)));
        let photograph = load_reduced_photograph(photo, MOST_TEXELS)?;
        let picture = photograph.brightness;
        let options = PhotoOptions { jpeg_divisor: photograph.jpeg_divisor, ..PhotoOptions::default() };
        let start = std::time::Instant::now();
        let surface = surface_from_photo(&picture, &options, |_| {})?;
        let seconds = start.elapsed().as_secs_f64();
        let r = displacement.map(|map| load_channel(map, Channel::Luma)).transpose()?;
        let r =
            r.filter(|truth| truth.raster.width == picture.width && truth.raster.height == picture.height);
        row(photo, &surface, r.map(|truth| correlation(&surface.displacement, &truth.raster)), seconds);
        if let Some(folder) = &maps {
            let name = Path::new(photo).file_stem().unwrap_or_default().to_string_lossy().into_owned();
            save_gray16(folder.join(format!("{name}_displacement.png")), &surface.displacement)?;
            save_gray16(folder.join(format!("{name}_roughness.png")), &surface.roughness)?;
        }
    }
    Ok(())
}

fn row(photo: &str, surface: &PhotoSurface, r: Option<f64>, seconds: f64) {
    let name = Path::new(photo).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let method = format!("{:?}", surface.shape.method).replace(' ', "");
    let warnings: Vec<String> = surface.doubts.iter().map(|d| format!("{d:?}").replace(' ', "")).collect();
    println!(
        "{name} {method} {} {:.2} {} {:.5} {:.4} {:.2} {:.2} {:.2} {} {seconds:.1} {}",
        if surface.sign.is_decided() { "decided" } else { "undecided" },
        surface.sign.confidence,
        r.map_or("-".to_owned(), |r| format!("{r:.2}")),
        surface.relief_m * 1e3,
        surface.micro_relief_m * 1e6,
        surface.roughness.mean(),
        surface.dimension.unwrap_or(f64::NAN),
        surface.noise * 255.0,
        surface.repetition.as_ref().map_or("no", |found| if found.wanders { "wanders" } else { "yes" }),
        warnings.join("; "),
    );
}

fn correlation(a: &Raster, b: &Raster) -> f64 {
    let (a, b) = (banded(a), banded(b));
    let sum = |p: &Raster, q: &Raster| p.values.iter().zip(&q.values).map(|(p, q)| p * q).sum::<f64>();
    sum(&a, &b) / (sum(&a, &a) * sum(&b, &b)).sqrt().max(f64::MIN_POSITIVE)
}

fn banded(raster: &Raster) -> Raster {
    let (w, h) = (raster.width, raster.height);
    let mut fft = Fft2::new(w, h);
    let mut spectrum = fft.spectrum(&raster.values);
    for (place, value) in spectrum.iter_mut().enumerate() {
        let r = angular_frequency(place / h, w).hypot(angular_frequency(place % h, h));
        *value *= if r < PI / 2.0 { high_pass(r, w, h) } else { 0.0 };
    }
    fft.image(&mut spectrum)
}
