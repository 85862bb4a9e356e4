//! A day of a game: `cargo run --release --example day -- HOURS`, an hour unless said.
//!
//! A finger strokes, bodies are struck, 11.6 of them a second come and go (a million a day). Every
//! minute something happens to the machine: the device comes back with another rate, audio stands
//! still, the game's clock jumps forward or begins anew, the game is paused; every ten minutes the
//! level is loaded again. Whatever happened, at the end of a level no strike is unaccounted for,
//! every sample was a number, the stamps lie where the audio is, and the process holds as much
//! memory as after the first level, within 1 %.

#[path = "../tests/common/counting.rs"]
mod counting;

use asperity::{
    Body, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Extent, Impact,
    Material, Renderer, Scene, Stock, Surface, SurfaceId,
};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;

const FRAME_S: f64 = 1.0 / 60.0;
const FRAMES_A_LEVEL: u64 = 600 * 60;
/// Bodies a frame: a million in 24 hours.
const BODIES_A_FRAME: f64 = 1e6 / (24.0 * 3600.0) * FRAME_S;
/// More bodies than the engine keeps when they have rung out.
const KEPT: usize = 20;
const RATES_HZ: [f64; 4] = [44_100.0, 48_000.0, 22_050.0, 32_000.0];

struct Day {
    scene: Scene,
    /// Audio half; none only while it is made anew.
    renderer: Option<Renderer>,
    rng: Rng,
    /// The game's own clock.
    game_s: f64,
    /// Frames for which audio stands still.
    halted: u32,
    owed_frames: f64,
    plane: SurfaceId,
    bodies: Vec<BodyId>,
    owed_bodies: f64,
    bodies_made: u64,
    /// Strikes that the scene took.
    strikes: u64,
    peak: f32,
}

fn plane(on: BodyId) -> Surface {
    let extent = Extent { width_m: 0.2, height_m: 0.2, relief_m: 1.0 };
    let map = HeightMap::flat(extent, 0.6).expect("a plane is a map");
    Surface::new(map, 0.2, 0.2).expect("a size that is accepted").body(on)
}

/// A body of a game: one of 48 kinds, or, once in fifty, of a size that no other has, whose level
/// is found anew.
fn bell(rng: &mut Rng) -> Body {
    let stock = [Stock::Bar, Stock::Plate, Stock::Bowl][rng.next_u32() as usize % 3];
    let place =
        if rng.next_u32().is_multiple_of(50) { rng.uniform() } else { f64::from(rng.next_u32() % 16) / 16.0 };
    Body::stock(stock, Material::STEEL, 0.08 + 0.1 * place).expect("a size that is accepted")
}

impl Day {
    fn new() -> Self {
        let Engine { mut scene, renderer, .. } = Config::live(44_100.0).build().expect("the live config");
        let mut rng = Rng::new(57);
        let body = scene.add_body(bell(&mut rng)).expect("there is room");
        let plane = scene.add_surface(plane(body)).expect("there is room");
        let bodies = vec![body];
        let (owed_frames, owed_bodies, game_s) = (0.0, 0.0, 0.0);
        let renderer = Some(renderer);
        Self {
            scene,
            renderer,
            rng,
            game_s,
            halted: 0,
            owed_frames,
            plane,
            bodies,
            owed_bodies,
            bodies_made: 1,
            strikes: 0,
            peak: 0.0,
        }
    }

    fn frame(&mut self, n: u64) {
        self.game_s += FRAME_S;
        self.touch(n);
        self.come_and_go();
        if n % 3600 == 3599 {
            self.something_happens();
        }
        self.render();
        self.scene.collect();
    }

    fn touch(&mut self, n: u64) {
        let second = n % 60;
        let at = 0.002 * second as f64;
        let sample = ContactSample { uv: [0.2 + at, 0.5], normal_force_n: 0.6, ..ContactSample::default() };
        let event = match second {
            0 => ContactEvent::begin(ContactId(1), self.plane, ChannelId(0), sample),
            55 => ContactEvent::end(ContactId(1)),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        let _ = self.scene.report(self.game_s, event);
        if n % 20 == 7 {
            let body = self.bodies[self.rng.next_u32() as usize % self.bodies.len()];
            let impact = Impact { speed_m_s: 0.1 + self.rng.uniform(), ..Impact::on(body) };
            self.strikes += u64::from(self.scene.report(self.game_s, ContactEvent::Impact(impact)).is_ok());
        }
    }

    fn come_and_go(&mut self) {
        self.owed_bodies += BODIES_A_FRAME;
        while self.owed_bodies >= 1.0 {
            self.owed_bodies -= 1.0;
            if self.bodies.len() > 8 {
                let gone = self.bodies.remove(1);
                self.scene.remove_body(gone).expect("a body that is there");
            }
            let body = bell(&mut self.rng);
            // Where audio stands still, the queue fills up.
            if let Ok(id) = self.scene.add_body(body) {
                self.bodies.push(id);
                self.bodies_made += 1;
            }
        }
    }

    fn something_happens(&mut self) {
        match self.rng.next_u32() % 5 {
            0 => {
                let which = self.rng.next_u32() as usize % RATES_HZ.len();
                self.at_rate(RATES_HZ[which]);
            }
            // The device is away for half a second to two.
            1 => self.halted = 30 + self.rng.next_u32() % 90,
            2 => self.game_s += 1e4 * self.rng.uniform(),
            3 => {
                self.scene.reset().expect("there is room");
                self.game_s = 0.0;
            }
            _ => {
                self.scene.pause().expect("there is room");
                self.scene.resume().expect("there is room");
            }
        }
    }

    fn level_again(&mut self) {
        for body in self.bodies.drain(1..) {
            self.scene.remove_body(body).expect("a body that is there");
        }
        self.scene.remove_surface(self.plane).expect("a surface that is there");
        self.plane = self.scene.add_surface(plane(self.bodies[0])).expect("there is room");
    }

    /// The end of a level: all that rings has rung out, at the rate that the day began with. The
    /// engine keeps some bodies that have rung out for the next of their kind; which ones, is the
    /// same each time.
    fn quiet(&mut self) {
        self.level_again();
        self.halted = 0;
        self.wait();
        for _ in 0..KEPT {
            let bar = Body::stock(Stock::Bar, Material::STEEL, 0.1).expect("a size that is accepted");
            let id = self.scene.add_body(bar).expect("there is room");
            self.bodies.push(id);
        }
        self.level_again();
        self.wait();
        self.at_rate(RATES_HZ[0]);
    }

    /// Twenty seconds in which nothing is reported.
    fn wait(&mut self) {
        for _ in 0..1200 {
            self.game_s += FRAME_S;
            self.render();
            self.scene.collect();
        }
    }

    fn at_rate(&mut self, rate_hz: f64) {
        let old = self.renderer.take().expect("a renderer");
        let new = self.scene.at_rate(old, rate_hz).expect("a rate that is accepted");
        assert!(new.lost.is_empty());
        self.renderer = Some(new.renderer);
    }

    fn render(&mut self) {
        if self.halted > 0 {
            self.halted -= 1;
            return;
        }
        let renderer = self.renderer.as_mut().expect("a renderer");
        self.owed_frames += renderer.sample_rate_hz() * FRAME_S;
        let (mut haptic, mut audio) = ([0.0; 256], [0.0; 256]);
        while self.owed_frames >= 256.0 {
            self.owed_frames -= 256.0;
            renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            let peak = haptic.iter().chain(&audio).fold(0.0f32, |peak, x| peak.max(x.abs()));
            assert!(haptic.iter().chain(&audio).all(|x| x.is_finite()), "a sample is no number");
            self.peak = self.peak.max(peak);
        }
    }
}

fn main() {
    let hours: f64 = std::env::args().nth(1).and_then(|hours| hours.parse().ok()).unwrap_or(1.0);
    let levels = (hours * 6.0).ceil().max(2.0) as u64;
    let (mut day, mut n, mut first) = (Day::new(), 0, 0);
    for level in 0..levels {
        for _ in 0..FRAMES_A_LEVEL {
            day.frame(n);
            n += 1;
        }
        day.quiet();
        let (stats, held) = (day.scene.stats(), counting::held_bytes());
        let gone = stats.stale + stats.too_soon;
        println!(
            "{:5.2} h  {} bodies  {} of {} strikes, {gone} of bodies that were gone  {held} bytes  peak {:.3}  ahead {}  quarantined {}",
            (level + 1) as f64 / 6.0,
            day.bodies_made,
            stats.impacts,
            day.strikes,
            day.peak,
            stats.ahead,
            stats.quarantined
        );
        assert!(stats.impacts + gone + 4 >= day.strikes, "strikes are lost: {stats:?}");
        assert!(stats.quarantined == 0 && day.peak > 1e-4, "{stats:?}");
        assert!(stats.ahead < 24_000, "the game's stamps are half a second off: {stats:?}");
        first = if level == 0 { held } else { first };
        let grown = (held - first) as f64 / first as f64;
        assert!(grown.abs() < 0.01, "memory has changed by {:.2} % since the first level", 100.0 * grown);
        day.peak = 0.0;
    }
    println!("{} bodies in {} h: nothing lost, memory flat", day.bodies_made, levels as f64 / 6.0);
}
