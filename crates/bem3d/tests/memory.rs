//! The memory that a contact says a solve needs, beside the peak of what the solve allocates.

#![allow(clippy::unwrap_used)] // Helpers of tests.
#![allow(unsafe_code)] // A counting allocator has to be one; it only counts and passes on.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Body, Boundary, ContactModel, Coupling, Friction, Hardness, Load, Output,
    Pair, PronySeries, Relaxing, Rheology, Scene, SelfAffine, Step, Surface,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes that are allocated now, and the most since the last look.
static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
/// The count is of the process: one measurement at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// In contact nearly everywhere, the estimated memory is at most this multiple of the measured peak.
const AT_MOST: f64 = 1.5;
/// The same with effects, whose need depends on more than the size.
const WITH_EFFECTS: f64 = 2.0;

struct PeakAllocator;

fn count(size: usize) {
    let now = NOW.fetch_add(size, Ordering::Relaxed) + size;
    PEAK.fetch_max(now, Ordering::Relaxed);
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for PeakAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(block, layout) }
    }
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size);
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: PeakAllocator = PeakAllocator;

/// A rough surface of bodies that are alike, with all outputs that its effects allow.
fn scene(boundary: Boundary, change: impl FnOnce(&mut Scene)) -> Scene {
    let surface = SelfAffine::new(2.4, 1.0, 0.01).map(Surface::SelfAffine).unwrap();
    let body = Body::Elastic { young: 2.0 * (1.0 - 0.09), poisson: 0.3 };
    let mut scene = Scene::of_pair(surface, Pair { first: body, second: body }).unwrap();
    scene.effects.boundary = boundary;
    change(&mut scene);
    for output in [Output::Stiffness, Output::Area, Output::Pressure, Output::Gap, Output::Displacement] {
        scene.outputs.ask(output, true);
    }
    scene.outputs.ask(Output::ContactPatches, true);
    if scene.effects.friction != Friction::Off {
        for output in [Output::Traction, Output::Slip, Output::TangentialStiffness] {
            scene.outputs.ask(output, true);
        }
    }
    scene
}

/// The estimated memory of a solve divided by its measured peak, load by load from no contact, on one thread: each
/// further thread that takes part in a factor reserves room for products of matrices of its own.
fn told_over_peak(scene: &Scene, model: Bem3d, force_bar: &[f64]) -> Vec<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| told_over_peak_here(scene, model, force_bar))
}

fn told_over_peak_here(scene: &Scene, model: Bem3d, force_bar: &[f64]) -> Vec<f64> {
    let mut contact = model.prepare(scene, 7).unwrap();
    let mut ratios = Vec::new();
    for &force_bar in force_bar {
        let load = Load::force(contact.normalisation().force(force_bar).unwrap());
        let told = contact.required_memory(load).unwrap().bytes;
        let held = NOW.load(Ordering::Relaxed);
        PEAK.store(held, Ordering::Relaxed);
        let state = contact.solve(load).unwrap();
        let peak = (PEAK.load(Ordering::Relaxed) - held) as f64;
        println!(
            "{} cells, {:?}, F_bar {force_bar}, {:.3} in contact: told {:.1} MB, peak {:.1} MB, ratio {:.2}",
            model.cells,
            scene.effects.boundary,
            state.area.unwrap(),
            1e-6 * told,
            1e-6 * peak,
            told / peak
        );
        ratios.push(told / peak);
    }
    ratios
}

fn alone() -> impl Drop {
    ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[test]
fn contact_nearly_everywhere() {
    let _alone = alone();
    for boundary in [Boundary::Free, Boundary::Periodic] {
        for (cells, rows, tolerance) in [
            (129, 129, 1e-8),
            (257, 257, 1e-6),
            (257, 180, 1e-6),
            (513, 513, 1e-4),
            (1025, 1025, 1e-3),
            (2049, 2049, 1e-2),
        ] {
            let model = Bem3d { cells, rows: Some(rows), tolerance, ..Bem3d::default() };
            // The second load begins with the first one.
            let loads: &[f64] = if cells < 1000 { &[100.0, 120.0] } else { &[100.0] };
            let ratios = told_over_peak(&scene(boundary, |_| ()), model, loads);
            // The estimate of the second load counts again what the first one left in memory.
            assert!(ratios[0] <= AT_MOST && ratios.iter().all(|r| *r >= 1.0), "{cells} x {rows}: {ratios:?}");
        }
    }
}

#[test]
fn light_and_middle_loads_need_no_more_than_is_told() {
    let _alone = alone();
    for boundary in [Boundary::Free, Boundary::Periodic] {
        for cells in [257, 700] {
            let model = Bem3d { cells, tolerance: 1e-4, ..Bem3d::default() };
            for force_bar in [1e-4, 1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0] {
                let [ratio] = told_over_peak(&scene(boundary, |_| ()), model, &[force_bar])[..] else {
                    continue;
                };
                assert!(ratio >= 1.0, "{cells}, F_bar {force_bar}: {ratio}");
            }
        }
    }
}

/// Adds an effect to a scene.
type Change = fn(&mut Scene);

#[test]
fn effects() {
    let _alone = alone();
    let changes: [(&str, Change, f64); 4] = [
        ("hardness", |scene| scene.effects.hardness = Hardness::Limit { pressure: 0.2 }, 15.0),
        (
            "friction",
            |scene| {
                scene.effects.friction = Friction::coulomb(0.3).with_coupling(Some(Coupling::Neglected));
            },
            100.0,
        ),
        ("short range", |scene| scene.effects.adhesion = Adhesion::ShortRange { work: 1e-6 }, 5.0),
        (
            "finite range",
            |scene| {
                let law = AdhesionLaw::Exponential;
                scene.effects.adhesion = Adhesion::FiniteRange { work: 1e-5, range: 0.01, law };
            },
            20.0,
        ),
    ];
    for (name, change, force_bar) in changes {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let model = Bem3d { cells: 129, tolerance: 1e-5, ..Bem3d::default() };
            println!("{name}");
            for ratio in told_over_peak(&scene(boundary, change), model, &[force_bar]) {
                assert!((1.0..=WITH_EFFECTS).contains(&ratio), "{name}, {boundary:?}: {ratio}");
            }
        }
    }
}

#[test]
fn a_viscoelastic_history() {
    let _alone = alone();
    // A thread that has ended before the next measurement, with all that it kept.
    std::thread::spawn(|| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
        pool.install(a_viscoelastic_history_here);
    })
    .join()
    .unwrap();
}

fn a_viscoelastic_history_here() {
    for (boundary, force_bar) in
        [(Boundary::Free, 100.0), (Boundary::Periodic, 30.0), (Boundary::Periodic, 1.0)]
    {
        let mut scene = scene(boundary, |_| ());
        (scene.pair, scene.outputs.stiffness) = (None, false);
        let arms: Vec<_> = [0.1, 1.0, 10.0].map(|time| Relaxing { weight: 1.0, time }).to_vec();
        scene.effects.rheology = Rheology::Prony(PronySeries::new(&arms).unwrap());
        let mut contact = Bem3d { cells: 257, tolerance: 1e-5, ..Bem3d::DEFAULT }.prepare(&scene, 7).unwrap();
        let load = Load::force(contact.normalisation().force(force_bar).unwrap());
        let told = contact.required_memory(load).unwrap().bytes;
        let held = NOW.load(Ordering::Relaxed);
        PEAK.store(held, Ordering::Relaxed);
        for time in [0.0, 1.0, 5.0] {
            contact.advance(Step::new(time, load)).unwrap();
        }
        let peak = (PEAK.load(Ordering::Relaxed) - held) as f64;
        let ratio = told / peak;
        println!(
            "{boundary:?} {force_bar}: told {:.1} MB, peak {:.1} MB, {ratio:.2}",
            1e-6 * told,
            1e-6 * peak
        );
        assert!((1.0..=2.0 * WITH_EFFECTS).contains(&ratio), "{boundary:?} {force_bar}: {ratio}");
    }
}
