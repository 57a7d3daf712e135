//! What is not named costs nothing: counts of work, of files, and of memory blocks as large as the grid.

#![allow(clippy::unwrap_used, clippy::expect_used)] // Helpers of tests.
#![allow(unsafe_code)] // A counting allocator has to be one; it only counts and passes on.

use contact_model::{ContactModel as _, Load};
use fractal_contact::scenes::{Options, Plan, SceneFile, SceneOutcome, run};
use runs::Silent;
use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Blocks of at least [`LARGE`] bytes that were asked for.
static BLOCKS: AtomicUsize = AtomicUsize::new(0);
/// Cells a side: so many that a grid is larger than a page of the report without fields.
const CELLS: usize = 257;
/// Numbers over the whole grid, in bytes.
const LARGE: usize = CELLS * CELLS * 8;
/// The count is of the process: one measurement at a time.
static ALONE: Mutex<()> = Mutex::new(());

struct CountingAllocator;

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        BLOCKS.fetch_add(usize::from(layout.size() >= LARGE), Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Iterated, so that the stiffness is a linear solve of its own: a factored set gives it beside the pressure.
const LOADS: [f64; 2] = [0.01, 0.1];

fn text(model: &str, effects: &str, outputs: &str) -> String {
    format!(
        "[scene]\nunits = \"none\"\nmodels = [\"{model}\"]\ncontact_modulus = 1\nforce_bar = [{}, {}]\n[scene.surface]\nkind = \"self_affine\"\n\
         side = 1\nhurst = 0.8\nrms_height = 0.01\n[models.{model}]\ncells = {CELLS}\nmethod = \"iterative\"\n[sampling]\nseed = 3\n[effects]\n{effects}\n[outputs]\n{outputs}\n",
        LOADS[0], LOADS[1]
    )
}

/// What was done: counts of the run, and blocks as large as the grid.
fn done(text: &str) -> (SceneOutcome, usize) {
    let scene = SceneFile::parse(Path::new("work.toml"), text.into()).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap_or_else(|e| panic!("{e}"));
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 1, fresh: true };
    let before = BLOCKS.load(Ordering::Relaxed);
    let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    let blocks = BLOCKS.load(Ordering::Relaxed) - before;
    assert_eq!(outcome.failed, 0, "{:?}", outcome.notes);
    (outcome, blocks)
}

/// Applications, linear solves, fields, bytes of fields, bytes of files, files, large blocks.
fn counts(text: &str) -> [u64; 7] {
    let (outcome, blocks) = done(text);
    let (_, cost, bytes) = outcome.actual[0];
    let [applications, solves, fields, held] =
        [cost.applications, cost.linear_solves, cost.fields, cost.field_bytes].map(|v| v as u64);
    [applications, solves, fields, held, bytes, outcome.files.len() as u64, blocks as u64]
}

#[test]
fn with_everything_off_a_scene_does_the_work_of_the_bare_solver() {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let [applications, linear_solves, fields, _, _, files, blocks] = counts(&text("bem3d", "", ""));
    let scene = SceneFile::parse(Path::new("work.toml"), text("bem3d", "", "")).unwrap();
    let model = bem3d::Bem3d { cells: CELLS, method: bem3d::Method::Iterative, ..bem3d::Bem3d::default() };
    let seed = scene.seed(0);
    let before = BLOCKS.load(Ordering::Relaxed);
    let mut bare = [0; 2];
    {
        let physics = scene.scene(&scene.models[0], seed).unwrap();
        let mut contact = model.prepare(&physics, seed).unwrap();
        let normalisation = contact.normalisation();
        for force_bar in LOADS {
            let state = contact.solve(Load::force(normalisation.force(force_bar).unwrap())).unwrap();
            bare[0] += state.report.applications;
            bare[1] += state.report.work.linear_solves;
        }
    }
    let large = BLOCKS.load(Ordering::Relaxed) - before;
    assert_eq!([applications, linear_solves, fields], [bare[0] as u64, bare[1] as u64, 0]);
    assert_eq!(blocks, large as u64, "blocks as large as the grid");
    assert_eq!(files, 3, "results.csv, report.html and manifest.json");
}

#[test]
fn every_output_has_its_work_and_without_it_none_is_done() {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let off = counts(&text("bem3d", "", ""));
    // Output, and which of the counts it raises.
    for (output, raised) in [
        ("stiffness = true", &[1][..]),
        ("conductance = { kind = \"electrical\", resistivities = [1, 1] }", &[1]),
        ("pressure = [\"npy\"]", &[2, 3, 4, 5, 6]),
        ("displacement = [\"npy\"]", &[0, 2, 3, 4, 5, 6]),
        ("gap = [\"png\"]", &[0, 2, 3, 4, 5, 6]),
        ("contact_patches = true", &[5]),
        ("curves = true", &[5]),
    ] {
        let on = counts(&text("bem3d", "", output));
        for &i in raised {
            assert!(on[i] > off[i], "{output}: count {i} is {} on and {} off", on[i], off[i]);
        }
        let named_off = output.split(" = ").next().unwrap().to_owned() + " = false";
        if !output.starts_with("conductance") {
            assert_eq!(counts(&text("bem3d", "", &named_off)), off, "{named_off}");
        }
    }
    // The area is counted anyway: it costs no work, only its column.
    assert_eq!(counts(&text("bem3d", "", "area = true")), off);
}

#[test]
fn every_effect_has_its_work_and_without_it_none_is_done() {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let free = counts(&text("bem3d", "boundary = \"free\"", ""));
    assert_eq!(free, counts(&text("bem3d", "", "")));
    let friction = |effects: &str| {
        text("equivalent", effects, "")
            .replace("contact_modulus = 1", "bodies = [\"rigid\", { young = 1, poisson = 0.3 }]")
            .replace(&format!("force_bar = [{}, {}]", LOADS[0], LOADS[1]), "path = [{ force = 0.001 }]")
    };
    let with = counts(&friction("friction = { coefficient = 0.3 }"));
    assert!(with[1] > free[1], "the table of k(d) is solved for friction alone: {with:?} {free:?}");
    let periodic = done(&text("bem3d", "boundary = \"periodic\"", "mean_gap = true")).0;
    assert!(periodic.actual[0].1.applications > 0.0);
}
