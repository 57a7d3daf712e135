//! Agreement with the stored results of other programs on the same surface: data/peers.

use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{Boundary, ContactModel, ContactState, Load, PreparedContact};
use std::path::PathBuf;
use surface_io::{Preprocessing, ReadOptions, Scan};
use tests::scene;

/// Accuracy that the reference states: approach and stiffness to 1e-6.
const AGREEMENT: f64 = 1e-6;

/// One row of the reference.
struct PeerRow {
    force_bar: f64,
    approach_over_h: f64,
    stiffness_bar: f64,
    contact_cells: usize,
}

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../data/peers").join(name)
}

fn rows() -> Vec<PeerRow> {
    let mut reader = csv::Reader::from_path(data("reference-N256-Df2.4.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let columns = ["force_bar", "approach_over_h", "stiffness_bar_1.1419", "contact_cells"].map(column);
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let [force_bar, approach_over_h, stiffness_bar, cells] =
                columns.map(|c| record[c].parse::<f64>().unwrap());
            PeerRow { force_bar, approach_over_h, stiffness_bar, contact_cells: cells as usize }
        })
        .collect()
}

fn prepared() -> Box<dyn PreparedContact> {
    let declared = ReadOptions { size: "1".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::read(data("surface_N256_Df2.4_seed1.npy"), &declared).unwrap();
    let map = scan.map(&Preprocessing::default()).unwrap();
    assert_eq!([map.columns(), map.rows()], [256, 256]);
    Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene(map), 0).unwrap()
}

fn press(contact: &mut dyn PreparedContact, row: &PeerRow) -> ContactState {
    let force = contact.normalisation().force(row.force_bar).unwrap();
    contact.solve(Load::force(force)).unwrap()
}

fn agree(contact: &dyn PreparedContact, state: &ContactState, row: &PeerRow) {
    let normalisation = contact.normalisation();
    let approach = normalisation.approach_over_h(state.approach.unwrap()).unwrap();
    assert_relative_eq!(approach, row.approach_over_h, max_relative = AGREEMENT);
    let stiffness = normalisation.stiffness_bar(state.stiffness.unwrap());
    assert_relative_eq!(stiffness, row.stiffness_bar, max_relative = AGREEMENT);
    assert_eq!(state.report.contact_cells, Some(row.contact_cells), "F_bar {}", row.force_bar);
}

#[test]
fn one_sweep_up_and_down() {
    let rows = rows();
    assert_eq!(rows.len(), 5);
    let mut contact = prepared();
    for row in rows.iter().chain(rows.iter().rev()) {
        let state = press(&mut *contact, row);
        agree(&*contact, &state, row);
    }
}

#[test]
fn each_load_alone() {
    for row in rows() {
        let mut contact = prepared();
        let state = press(&mut *contact, &row);
        agree(&*contact, &state, &row);
    }
}

/// Contact cells of the elastic first step of a viscoelastic map of others, by a reference implementation for
/// cells under constant pressure. The program that the map comes from has another discretisation, with 612 and
/// 4645 cells, which the same implementation finds with it (python/tests/test_periodic_map.py).
#[test]
fn a_periodic_map_under_two_pressures() {
    let declared = ReadOptions { size: "1".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::read(data("surface_maxwell_N256.npy"), &declared).unwrap();
    let mut scene = scene(scan.map(&Preprocessing::default()).unwrap());
    // 4 G for nu = 1/2: an elastic branch of G = 1, and 50 of G = 3 in a step of time of 1/6.
    let branches = (0..50).map(|i| 10_f64.powf(-1.0 + 10.0 * f64::from(i) / 49.0));
    scene.contact_modulus = 4.0 * (1.0 + 3.0 * branches.map(|tau| tau / (tau + 1.0 / 6.0)).sum::<f64>());
    assert_relative_eq!(scene.contact_modulus, 575.0927, max_relative = 1e-7);
    scene.effects.boundary = Boundary::Periodic;
    let mut contact = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
    for (mean_pressure, cells, of_the_source) in [(2.0, 607, 612.0), (16.0, 4605, 4645.0)] {
        let state = contact.solve(Load::force(mean_pressure)).unwrap();
        assert_eq!(state.report.contact_cells, Some(cells));
        assert_relative_eq!(cells as f64, of_the_source, max_relative = 0.01);
    }
}
