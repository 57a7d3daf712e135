//! What scenes tell of friction in two directions: a block on a spring, which sticks and slips as a whole.

use contact_model::{
    Abilities, Boundary, ContactModel, ContactState, Coupling, Directions, Effect, Error, Field, Fields,
    FrictionLaw, Load, LoadKind, NormalLoad, Normalisation, Output, Paths, PreparedContact, Result, Scene,
    SolveReport, Source, Step, StickSlip, Stop, Surface, SurfaceKind, Tangential, TangentialState,
};
use fractal_contact::scenes::{Options, Plan, Registry, SceneFile, run};
use runs::{CsvFile, Silent};

const NAME: &str = "block";
/// Tangential stiffness of the block's spring.
const STIFFNESS: f64 = 2.0;

/// Pictures outline the contact by its pressure.
const OUTPUTS: &[Output] = &[
    Output::Pressure,
    Output::StickArea,
    Output::TangentialStiffness,
    Output::TangentialStiffnessStuck,
    Output::Traction,
    Output::Slip,
    Output::StickSlip,
];

struct BlockModel;

impl ContactModel for BlockModel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[SurfaceKind::Heights],
            boundaries: &[Boundary::Free],
            effects: &[Effect::Friction, Effect::FullCoupling],
            loads: LoadKind::ALL,
            paths: Paths::Remembered,
            directions: Directions::Plane,
            outputs: OUTPUTS,
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let Some(FrictionLaw { coefficient, .. }) = scene.effects.friction.law() else {
            return Err(Error::unsupported(NAME, "a contact without friction"));
        };
        let coupling = scene.coupling(NAME)?;
        Ok(Box::new(PreparedBlock { scene: scene.clone(), coefficient, coupling, slip: [0.0; 2] }))
    }
}

struct PreparedBlock {
    scene: Scene,
    coefficient: f64,
    coupling: Option<Coupling>,
    slip: [f64; 2],
}

impl PreparedBlock {
    fn fields(&self, force: f64, traction: [f64; 2], class: StickSlip) -> Result<Fields> {
        let Surface::Heights(map) = &self.scene.surface else { return Ok(Fields::default()) };
        let count = map.heights().len();
        let field = |value: f64| Field::new(map.cells(), map.size(), vec![value; count]);
        let area = map.size().x * map.size().y;
        let mut fields = Fields::default();
        let outputs = &self.scene.outputs;
        if outputs.pressure {
            fields.pressure = Some(field(force / area)?);
        }
        if outputs.traction {
            fields.traction = Some([field(traction[0] / area)?, field(traction[1] / area)?]);
        }
        if outputs.slip {
            fields.slip = Some([field(self.slip[0])?, field(self.slip[1])?]);
        }
        if outputs.stick_slip {
            fields.stick_slip = Some(field(class.value())?);
        }
        Ok(fields)
    }
}

impl PreparedContact for PreparedBlock {
    fn normalisation(&self) -> Normalisation {
        Normalisation {
            contact_modulus: self.scene.contact_modulus,
            length: self.scene.surface.size().length(),
            height: None,
        }
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, _stop: Stop<'_>) -> Result<ContactState> {
        let step = step.validated(f64::NEG_INFINITY)?;
        let Load { normal, tangential } = step.load;
        let NormalLoad::Force(force) = normal else { return Err(Error::unsupported_load(NAME, normal)) };
        let limit = self.coefficient * force;
        let size = self.scene.surface.size();
        let area = size.x * size.y;
        let [slip_x, slip_y] = self.slip;
        let (traction, displacement, slips) = match tangential {
            Tangential::Force([x, y]) => {
                if x.hypot(y) > limit {
                    return Err(Error::gross_slip(x.hypot(y), limit));
                }
                ([x, y], [x / STIFFNESS + slip_x, y / STIFFNESS + slip_y], false)
            }
            Tangential::Displacement([x, y]) => {
                let stuck = [STIFFNESS * (x - slip_x), STIFFNESS * (y - slip_y)];
                let beyond = stuck[0].hypot(stuck[1]) / limit;
                let traction = stuck.map(|q| q / beyond.max(1.0));
                ([traction[0], traction[1]], [x, y], beyond > 1.0)
            }
            other => return Err(Error::unsupported_load(NAME, other)),
        };
        if slips {
            self.slip =
                [displacement[0] - traction[0] / STIFFNESS, displacement[1] - traction[1] / STIFFNESS];
        }
        let outputs = &self.scene.outputs;
        let stuck = [[STIFFNESS, 0.0], [0.0, 0.5 * STIFFNESS]];
        let along = if slips { [[0.0, 0.25], [0.25, 1.0]] } else { stuck };
        let (stick_area, slip_area) = if slips { (0.0, area) } else { (area, 0.0) };
        let asked = outputs.stick_area;
        let tangential = TangentialState::new(traction, displacement)
            .with_sliding_force(limit)
            .with_areas(asked.then_some(stick_area), asked.then_some(slip_area))
            .with_stiffness(outputs.tangential_stiffness.then_some(along))
            .with_stiffness_stuck(outputs.tangential_stiffness_stuck.then_some(stuck));
        let mut report =
            SolveReport::exact(if self.coupling == Some(Coupling::Full) { "coupled" } else { "block" });
        report.certificate.tangential_duality_gap = Some(1e-9);
        report.certificate.tangential_load_error = Some(2e-9);
        report.certificate.tangential_stiffness_error = outputs.tangential_stiffness.then_some(3e-9);
        let class = if slips { StickSlip::Slip } else { StickSlip::Stick };
        let fields = self.fields(force, traction, class)?;
        Ok(ContactState::new(force, report)
            .with_time(step.time)
            .with_tangential(tangential)
            .with_fields(fields))
    }

    fn restart(&mut self) {
        self.slip = [0.0; 2];
    }
}

const SCENE: &str = r#"
[scene]
models = ["block"]
bodies = ["rigid", { young = "1 GPa", poisson = 0.25 }]

[scene.surface]
kind = "file"
path = "map.npy"
unit = "um"
size = ["2 m", "1 m"]

[[scene.path]]
mean_pressure = "5 Pa"

[[scene.path]]
tangential_force = ["1.2 N", "-0.9 N"]
states = 3

[[scene.path]]
tangential_displacement = ["3 m", "4 m"]

[effects]
friction = { coefficient = 0.3, coupling = "none" }

[outputs]
stick_area = true
tangential_stiffness = true
tangential_stiffness_stuck = true
traction = ["npy", "png", "vti"]
slip = ["png"]
stick_slip = ["npy", "png"]
curves = true
"#;

fn parsed(text: &str, directory: &std::path::Path) -> fractal_contact::scenes::Result<SceneFile> {
    let map = surface_io::npy(&[2, 3], &[0.0, 1.0, 2.0, 1.0, 0.5, 0.0]).unwrap();
    std::fs::write(directory.join("map.npy"), map).unwrap();
    let registry = Registry::new().with(BlockModel, "1").unwrap();
    SceneFile::parse_with(&directory.join("block.toml"), text.into(), &registry)
}

#[test]
fn friction_of_two_directions_is_told_everywhere() {
    let dir = tempfile::tempdir().unwrap();
    let scene = parsed(SCENE, dir.path()).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap_or_else(|e| panic!("{e}"));
    assert!(plan.to_string().contains("coupling of normal and tangential tractions neglected"), "{plan}");
    let out = dir.path().join("out");
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    let file = CsvFile::read(&out.join("results.csv")).unwrap();
    let of = |name: &str| {
        let column = file.numbers(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        column.into_iter().map(Option::unwrap).collect::<Vec<f64>>()
    };
    let close = |name: &str, expected: [f64; 5]| {
        let found = of(name);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {found:?}");
    };
    // 5 Pa on 2 m^2 are 10 N; mu F = 3 N. The last step slips along (3, 4)/5.
    close("force", [10.0; 5]);
    close("sliding_force", [3.0; 5]);
    close("tangential_force", [0.0, 0.4, 0.8, 1.2, 1.8]);
    close("tangential_force_y", [0.0, -0.3, -0.6, -0.9, 2.4]);
    close("tangential_displacement", [0.0, 0.2, 0.4, 0.6, 3.0]);
    close("tangential_displacement_y", [0.0, -0.15, -0.3, -0.45, 4.0]);
    close("stick_area", [2.0, 2.0, 2.0, 2.0, 0.0]);
    close("slip_area", [0.0, 0.0, 0.0, 0.0, 2.0]);
    for (name, stuck, slipping) in [
        ("tangential_stiffness", 2.0, 0.0),
        ("tangential_stiffness_xy", 0.0, 0.25),
        ("tangential_stiffness_y", 1.0, 1.0),
        ("tangential_stiffness_stuck", 2.0, 2.0),
        ("tangential_stiffness_stuck_xy", 0.0, 0.0),
        ("tangential_stiffness_stuck_y", 1.0, 1.0),
    ] {
        close(name, [stuck, stuck, stuck, stuck, slipping]);
    }
    close("tangential_duality_gap", [1e-9; 5]);
    close("tangential_load_error", [2e-9; 5]);
    close("tangential_stiffness_error", [3e-9; 5]);
    for note in file.texts("note").unwrap() {
        assert_eq!(note, "coupling of normal and tangential tractions neglected");
    }
    for (field, formats) in
        [("traction", &["npy", "png", "vti"][..]), ("slip", &["png"]), ("stick_slip", &["npy", "png"])]
    {
        for format in formats {
            assert!(out.join(format!("{field}-{NAME}-0-004.{format}")).is_file(), "{field}.{format}");
        }
    }
    let numbers = |name: &str| {
        let bytes = std::fs::read(out.join(name)).unwrap();
        // The header ends with the first line.
        let head = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        bytes[head..].as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect::<Vec<f64>>()
    };
    assert_eq!(numbers("stick_slip-block-0-004.npy"), [2.0; 6]);
    let traction = numbers("traction-block-0-004.npy");
    assert_eq!(traction.len(), 12);
    assert!(traction[..6].iter().all(|q| (q - 0.9).abs() < 1e-12), "{traction:?}");
    assert!(traction[6..].iter().all(|q| (q - 1.2).abs() < 1e-12), "{traction:?}");
    assert!(
        outcome.summary.contains("tangential_") && outcome.summary.contains("force_y"),
        "{}",
        outcome.summary
    );
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    for told in ["tangential duality gap", ">open<", ">slip<", "tangential traction"] {
        assert!(report.contains(told), "{told}");
    }
    assert!(out.join("curve-tangential_force.svg").is_file());
}

/// The block has no approach: a piece that would begin at it is refused by name, and what is before it stands.
#[test]
fn a_piece_that_begins_at_a_quantity_which_a_model_lacks_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let text =
        SCENE.replace("tangential_displacement = [\"3 m\", \"4 m\"]", "approach = \"1 um\"\nstates = 2");
    let scene = parsed(&text, dir.path()).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::calibrated(&scene).unwrap_or_else(|e| panic!("{e}"));
    let out = dir.path().join("out");
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    assert_eq!((outcome.requested, outcome.states, outcome.failed), (6, 5, 1));
    let file = CsvFile::read(&out.join("results.csv")).unwrap();
    assert_eq!(file.texts("status").unwrap()[4], "refused");
    let note = file.texts("note").unwrap()[4].to_owned();
    assert!(note.contains("block") && note.contains("begins to prescribe an approach"), "{note}");
}

#[test]
fn bodies_that_couple_are_asked_how_where_a_model_can_do_either() {
    let dir = tempfile::tempdir().unwrap();
    let message = |text: &str| parsed(text, dir.path()).unwrap_err().to_string();
    let coefficient = "friction = { coefficient = 0.3 }";
    let silent = SCENE.replace("friction = { coefficient = 0.3, coupling = \"none\" }", coefficient);
    let asked = message(&silent);
    assert!(
        asked.contains("second Dundurs constant -0.3333") && asked.contains("block.toml:23:1"),
        "{asked}"
    );
    assert!(asked.contains("`coupling = \"none\"`") && asked.contains("`coupling = \"full\"`"), "{asked}");
    // Bodies that are alike are not asked.
    let alike = silent.replace("\"rigid\"", "{ young = \"1 GPa\", poisson = 0.25 }");
    assert!(parsed(&alike, dir.path()).is_ok());
    let full = SCENE.replace("\"none\"", "\"full\"");
    let scene = parsed(&full, dir.path()).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap_or_else(|e| panic!("{e}"));
    assert!(plan.to_string().contains("solved together"), "{plan}");
    let out = dir.path().join("out");
    let options = Options { out: out.clone(), threads: 1, fresh: false };
    run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    let file = CsvFile::read(&out.join("results.csv")).unwrap();
    assert!(file.texts("note").unwrap().iter().all(|note| note.is_empty()));
    assert!(file.texts("strategy").unwrap().iter().all(|strategy| *strategy == "coupled"));
}
