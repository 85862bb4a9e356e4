//! Reading a surface never touches the heap: counted, not believed.

use asperity_surface::combine::{BandSplit, Crossfade, Mask, Scale, Source, Sum};
use asperity_surface::combine::{CrossfadeTo, ScaleTo};
use asperity_surface::height_field::{MAX_BLOCK, PathBlock, SurfaceBlock, Touch};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::{SandDesign, SandSource};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use std::any::Any;

/// Counts what the current thread allocates and frees.
mod counting {
    #![allow(unsafe_code)]
    use std::alloc::{GlobalAlloc, Layout, System};
    use std::cell::Cell;

    pub struct Counting;

    thread_local! {
        pub static COUNT: Cell<u64> = const { Cell::new(0) };
    }

    fn count() {
        let _ = COUNT.try_with(|c| c.set(c.get() + 1));
    }

    // SAFETY: every call is passed on to the system's allocator unchanged.
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            count();
            // SAFETY: the caller's promise is passed on.
            unsafe { System.alloc(layout) }
        }

        unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
            count();
            // SAFETY: the caller's promise is passed on.
            unsafe { System.dealloc(pointer, layout) }
        }
    }

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;
}

/// Heap operations while a source is read, touched and changed for a second.
fn heap_operations(source: &mut Source, change: &dyn Any) -> u64 {
    let position = [[0.0, 0.0]; MAX_BLOCK].map(|_: [f64; 2]| [0.01, 0.02]);
    let mut out = SurfaceBlock::default();
    let before = counting::COUNT.get();
    for block in 0..700_u64 {
        let mut position = position;
        for (i, p) in position.iter_mut().enumerate() {
            p[0] += 1e-6 * (64 * block + i as u64) as f64;
        }
        let sample = 64 * block;
        if block % 100 == 50 {
            source.set(change, sample);
        }
        source.touch(&Touch {
            contact: 0,
            sample,
            position_m: position[0],
            velocity_m_s: [0.0441, 0.0],
            normal_force_n: 0.5,
            ..Touch::default()
        });
        source.sample(
            &PathBlock {
                position_m: &position,
                velocity_m_s: &[[0.0441, 0.0]; MAX_BLOCK],
                footprint_m: &[1e-6; MAX_BLOCK],
                normal_force_n: &[],
                first_sample: sample,
                contact: 0,
                slopes: true,
                ..PathBlock::default()
            },
            &mut out,
        );
    }
    counting::COUNT.get() - before
}

fn solid(material: SolidMaterial) -> Source {
    Box::new(SolidNoise::new(material.parameters(), 1).unwrap())
}

fn lattice() -> Source {
    let cell = Raster::from_fn(16, 16, |x, y| 1e-5 * (x * y % 7) as f64);
    Box::new(Lattice::new(&cell, [0.01, 0.0], [0.003, 0.01]).unwrap())
}

#[test]
fn no_source_allocates_while_it_is_read_touched_and_changed() {
    let wood = SolidMaterial::Wood.parameters();
    let two = || (solid(SolidMaterial::Sand), lattice());
    let cases: Vec<(&str, Source, Box<dyn Any>)> = vec![
        ("solid noise", solid(SolidMaterial::Gravel), Box::new(wood)),
        ("lattice", lattice(), Box::new(wood)),
        ("sum", Box::new(Sum::new(vec![two().0, two().1])), Box::new(wood)),
        ("scale", Box::new(Scale::new(lattice(), 0.5).unwrap()), Box::new(ScaleTo(0.7))),
        ("mask", Box::new(Mask::new(lattice(), two().0, two().1)), Box::new(wood)),
        ("crossfade", Box::new(Crossfade::new(two().0, two().1)), Box::new(CrossfadeTo(0.3))),
        ("band split", Box::new(BandSplit::new(two().0, two().1, 1e-3).unwrap()), Box::new(wood)),
    ];
    for (name, mut source, change) in cases {
        assert_eq!(heap_operations(&mut source, &*change), 0, "{name}");
    }
}

#[test]
fn sand_allocates_nothing_in_audio_while_simulated_elsewhere() {
    let design = SandDesign { cells: 200, ..SandDesign::default() };
    let (sand, worker) = SandSource::threaded(&design, 1).unwrap();
    let thread = worker.spawn();
    let mut sand: Source = Box::new(sand);
    let law = asperity_surface::sand::SandLaw::default();
    for _ in 0..20 {
        assert_eq!(heap_operations(&mut sand, &law), 0);
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(thread.stop().is_some());
}

#[cfg(feature = "brownian")]
#[test]
fn a_brownian_path_does_not_allocate_while_it_is_read() {
    use asperity_surface::brownian::BrownianDesign;
    use asperity_surface::brownian::rendering::{BrownianPath, Rendering};
    let heights = BrownianDesign::new(0.5, 1e-4, 1).path().unwrap();
    let mut path: Source = Box::new(BrownianPath::new(&heights, 5e-4, Some(Rendering::Lateral)).unwrap());
    assert_eq!(heap_operations(&mut path, &ScaleTo(1.0)), 0);
}
