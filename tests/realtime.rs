//! The audio half never allocates or frees, whatever happens: events of every kind, surfaces and bodies
//! swapped and removed while they sound, voices stolen, contacts lapsing, hostile numbers.

mod common;

use asperity::{
    Actuator, Config, ContactEvent, ContactId, ContactSample, Excitation, Impact, Material, ModalModel,
    Renderer, Residual, Scene, SurfaceId,
};
use asperity_dsp::rng::Rng;
use common::{bar, grating, plate};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static WATCHED: Cell<bool> = const { Cell::new(false) };
    static TOUCHED: Cell<u64> = const { Cell::new(0) };
    /// Bytes allocated less bytes freed on this thread.
    static HELD: Cell<i64> = const { Cell::new(0) };
}

fn hold(bytes: i64) {
    HELD.with(|held| held.set(held.get() + bytes));
}

fn note() {
    if WATCHED.with(Cell::get) {
        TOUCHED.with(|touched| touched.set(touched.get() + 1));
    }
}

// SAFETY: every call is passed on to the system allocator unchanged; the counters are plain
// thread-local cells without destructors, so they may be touched inside an allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        hold(layout.size() as i64);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        note();
        hold(-(layout.size() as i64));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        hold(size as i64 - layout.size() as i64);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Heap operations of `work` on this thread.
fn heap_operations(work: impl FnOnce()) -> u64 {
    TOUCHED.with(|touched| touched.set(0));
    WATCHED.with(|watched| watched.set(true));
    work();
    WATCHED.with(|watched| watched.set(false));
    TOUCHED.with(Cell::get)
}

#[test]
fn the_counting_allocator_counts() {
    assert!(heap_operations(|| drop(std::hint::black_box(vec![1u8; 100]))) >= 2);
    assert_eq!(heap_operations(|| ()), 0);
}

#[test]
fn the_renderer_can_move_to_the_audio_thread() {
    fn is_send<T: Send>() {}
    is_send::<Renderer>();
    is_send::<Scene>();
}

/// A body whose impacts also play a residual.
fn clicking_bar() -> ModalModel {
    let samples = (0..3000).map(|n| (0.7 * n as f32).sin() / (1.0 + n as f32)).collect();
    bar().with_residual(Some(Residual { sample_rate_hz: 48_000.0, samples }), 1.0).unwrap()
}

struct Game {
    scene: Scene,
    surfaces: Vec<SurfaceId>,
    bodies: Vec<asperity::BodyId>,
    rng: Rng,
    time_s: f64,
}

impl Game {
    fn number(&mut self) -> f64 {
        match self.rng.next_u32() % 40 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => 1e300,
            3 => -0.3,
            _ => self.rng.uniform(),
        }
    }

    fn step(&mut self) {
        self.time_s += 0.004 * self.rng.uniform();
        for _ in 0..4 {
            let contact = ContactId(u64::from(self.rng.next_u32() % 12));
            let sample = ContactSample {
                uv: [self.number(), self.number()],
                velocity_m_s: (!self.rng.next_u32().is_multiple_of(5)).then(|| [0.3 * self.number(), 0.0]),
                normal_force_n: 3.0 * self.number(),
                closing_m_s: (0.1 * self.number()).abs(),
            };
            let surface = self.surfaces[self.rng.next_u32() as usize % self.surfaces.len()];
            let event = match self.rng.next_u32() % 12 {
                0 | 1 => ContactEvent::begin(contact, surface, Actuator(0), sample),
                2 => ContactEvent::end(contact),
                3 => ContactEvent::Impact(Impact {
                    body: self.bodies[0],
                    other: Some(self.bodies[1]),
                    speed_m_s: 1.0,
                    mass_kg: 0.01,
                    radius_m: 0.005,
                    striker: Material::STEEL,
                    restitution: 0.7,
                    position: 0,
                }),
                _ => ContactEvent::moved(contact, sample),
            };
            // Refusals are part of the game.
            let _ = self.scene.report(self.time_s, event);
        }
        self.swap();
    }

    fn swap(&mut self) {
        let which = self.rng.next_u32() as usize % self.surfaces.len();
        let body = self.bodies[which % 2];
        match self.rng.next_u32() % 50 {
            0 => {
                let surface = plate(0.5).on(body).excitation(Excitation::Both);
                let _ = self.scene.replace_surface(self.surfaces[which], surface);
            }
            1 => {
                let removed = self.scene.remove_surface(self.surfaces[which]).is_ok();
                if removed && let Ok(id) = self.scene.add_surface(grating(2e-3, 1e-4).on(body)) {
                    self.surfaces[which] = id;
                }
            }
            2 => {
                let _ = self.scene.replace_body(body, clicking_bar(), Material::GLASS);
            }
            3 => {
                let gain = self.rng.uniform();
                let _ = self.scene.set_haptic_gain(Actuator(0), gain);
            }
            4 => {
                let removed = self.scene.remove_body(self.bodies[which % 2]).is_ok();
                if removed && let Ok(id) = self.scene.add_body(bar()) {
                    self.bodies[which % 2] = id;
                }
            }
            _ => {}
        }
    }
}

#[test]
fn ten_minutes_of_randomised_events_touch_no_heap_on_the_audio_half() {
    let config = Config { max_contacts: 6, contact_timeout_s: 0.05, ..Config::default() };
    let (mut scene, mut renderer) = config.build().unwrap();
    let bodies = vec![scene.add_body(clicking_bar()).unwrap(), scene.add_body(bar()).unwrap()];
    let surfaces = vec![
        scene.add_surface(grating(1e-3, 5e-5).on(bodies[0])).unwrap(),
        scene.add_surface(plate(1.0).on(bodies[1])).unwrap(),
        scene.add_surface(plate(0.0)).unwrap(),
    ];
    let mut game = Game { scene, surfaces, bodies, rng: Rng::new(5), time_s: 0.0 };
    let (mut haptic, mut audio) = (vec![0.0f32; 512], vec![0.0f32; 512]);
    let mut touched = 0;
    let mut peak = 0.0f32;
    while game.time_s < 600.0 {
        let until = game.time_s + 0.005;
        while game.time_s < until {
            game.step();
        }
        while (renderer.position() as f64) < game.time_s * renderer.sample_rate_hz() {
            let frames = 1 + game.rng.next_u32() as usize % 512;
            let (h, a) = (&mut haptic[..frames], &mut audio[..frames]);
            touched += heap_operations(|| renderer.render(&mut [&mut *h], &mut [&mut *a]));
            for x in h.iter().chain(a.iter()) {
                assert!(x.is_finite());
                peak = peak.max(x.abs());
            }
        }
        game.scene.collect();
    }
    let stats = game.scene.stats();
    assert_eq!(touched, 0, "heap operations on the audio half");
    assert!(peak > 0.0);
    for (name, count) in [
        ("events", stats.events),
        ("impacts", stats.impacts),
        ("refused", stats.refused),
        ("stolen", stats.stolen),
        ("lapsed", stats.lapsed),
        ("orphaned", stats.orphaned),
        ("debounced", stats.debounced),
        ("micro_collisions", stats.micro_collisions),
    ] {
        assert!(count > 0, "the random game never met: {name}");
    }
}

#[test]
fn a_flood_of_a_million_events_a_second_for_ten_seconds_needs_no_more_memory() {
    let (mut scene, mut renderer) = Config::default().build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.8).on(body)).unwrap();
    let sample = |u: f64| ContactSample {
        uv: [u, 0.5],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
    };
    let contacts = 10u64;
    for contact in 0..contacts {
        let event = ContactEvent::begin(ContactId(contact), surface, Actuator(0), sample(0.1));
        scene.report(0.0, event).unwrap();
    }
    let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
    let (mut reported, mut handed_back, mut touched) = (contacts, 0u64, 0);
    let mut step = 0.0f64;
    let held = HELD.with(Cell::get);
    let mut most = 0;
    for microsecond in 0..10_000_000u64 {
        let time_s = microsecond as f64 * 1e-6;
        let event = ContactEvent::moved(ContactId(microsecond % contacts), sample(0.1 + 0.7 * time_s));
        reported += 1;
        handed_back += u64::from(scene.report(time_s, event).is_err());
        if microsecond % 64 == 0 {
            most = most.max(HELD.with(Cell::get) - held);
        }
        while (renderer.position() as f64) < time_s * renderer.sample_rate_hz() {
            touched += heap_operations(|| renderer.render(&mut [&mut haptic], &mut [&mut audio]));
            step = haptic.iter().chain(&audio).fold(step, |peak, x| peak.max(f64::from(x.abs())));
        }
    }
    let stats = scene.stats();
    eprintln!("{most} bytes more, {stats:?}");
    assert_eq!(touched, 0);
    assert!(most < 64 * 1024, "{most} bytes");
    assert!(step > 0.0 && step.is_finite());
    assert_eq!(stats.dropped, handed_back);
    let waiting = reported - stats.events - stats.superseded - stats.dropped;
    assert!(waiting <= 4096 + contacts, "{waiting} events are nowhere: {stats:?}");
    assert_eq!((stats.contacts, stats.lapsed), (contacts, 0), "no finger is lost in the flood");
}
