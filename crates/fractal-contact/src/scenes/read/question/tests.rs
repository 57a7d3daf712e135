//! A question is the same in every way to ask it.

use super::*;
use crate::scenes::read::loads::LoadList;
use crate::scenes::read::{
    Distributed, FieldFormat, FilmMaterial, PrescribedLoad, RequestedFilm, RequestedInterface,
    RequestedLeakage, RequestedStress,
};
use contact_model::{
    Adhesion, AdhesionLaw, Boundary, Conductance, Coupling, Friction, FrictionLaw, Hardness, Layer,
    LayerBase, Output, PronySeries, Relaxing, Rheology, Tangential,
};
use interface::FlowAxis;
use interface::stress::LoadedBody;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;
use proptest::sample::{select, subsequence};
use std::path::PathBuf;
use surface_gen::TwinSpectrum;
use surface_io::{
    AlignLines, Axes, Border, ChannelChoice, Crop, Decimal, Detrend, Fill, Format, Mirror, Preprocessing,
    Quantity, ReadOptions, Sides, Undefined, Window,
};

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![1e-12..1e12_f64, select(vec![0.1, 0.3, 1e-6, 1.0, 210e9, 5e-7, 2.5e-3])]
}

fn share() -> impl Strategy<Value = f64> {
    0.0..0.5_f64
}

fn size() -> impl Strategy<Value = contact_model::Size> {
    [positive(), positive()].prop_map(contact_model::Size::from)
}

fn material() -> impl Strategy<Value = Material> {
    let body = || {
        prop_oneof![
            Just(Body::Rigid),
            (positive(), share()).prop_map(|(young, poisson)| Body::Elastic { young, poisson })
        ]
    };
    prop_oneof![
        positive().prop_map(Material::ContactModulus),
        (body(), positive(), share()).prop_map(|(first, young, poisson)| {
            Material::Bodies(Pair { first, second: Body::Elastic { young, poisson } })
        })
    ]
}

fn loads() -> BoxedStrategy<AskedLoads> {
    let kinds = [
        PrescribedLoad::Force,
        PrescribedLoad::ForceBar,
        PrescribedLoad::MeanPressure,
        PrescribedLoad::Approach,
        PrescribedLoad::MeanGap,
    ];
    let list = (select(kinds.to_vec()), vec(positive(), 1..4))
        .prop_map(|(kind, values)| AskedLoads::Loads(LoadList { kind, values }));
    let normal = (select(vec![kinds[0], kinds[2], kinds[3], kinds[4]]), positive());
    let pair = || (positive(), prop_oneof![Just(0.0), positive()]).prop_map(<[f64; 2]>::from);
    let tangential =
        prop_oneof![pair().prop_map(Tangential::Force), pair().prop_map(Tangential::Displacement)];
    let step = (positive().prop_map(Some), of(normal), of(tangential), of(1..9_u64))
        .prop_map(|(time, normal, tangential, states)| AskedStep { time, normal, tangential, states });
    prop_oneof![list, vec(step, 1..4).prop_map(AskedLoads::Path)].boxed()
}

fn self_affine() -> BoxedStrategy<AskedSelfAffine> {
    let waves = (of(positive()), of(positive()), of(positive()), of(share()), of(positive()));
    (of(size()), of(share()), of(positive()), waves)
        .prop_map(
            |(
                size,
                hurst,
                rms_height,
                (roll_off_wavelength, shortest_wavelength, anisotropy, lay, weibull),
            )| {
                AskedSelfAffine {
                    size,
                    hurst,
                    rms_height,
                    roll_off_wavelength,
                    shortest_wavelength,
                    anisotropy,
                    lay,
                    weibull,
                }
            },
        )
        .boxed()
}

/// What is done to a map whose lengths have this dimension.
fn preprocessing(dimension: Dimension) -> BoxedStrategy<Preprocessing> {
    let length = move || length_of(dimension);
    let crop = prop_oneof![
        Just(Crop::Centre),
        Just(Crop::Defined),
        (0..9_usize, 0..9_usize, 1..9_usize, 1..9_usize)
            .prop_map(|(row, column, rows, columns)| Crop::Window { row, column, rows, columns })
    ];
    let holes = prop_oneof![
        Just((None, None)),
        Just((None, Some(Undefined::NoContact))),
        prop_oneof![Just(Fill::Neighbours), Just(Fill::Plane), length().prop_map(Fill::Value)]
            .prop_map(|fill| (Some(fill), None))
    ];
    (
        (of(crop), of(select(AlignLines::ALL.to_vec())), of(positive()), of(positive()), of(length())),
        (holes, of(length()), of(select(Mirror::ALL.to_vec())), 0..4_u8),
        (of(select(Window::ALL.to_vec())), of(1..99_usize), of(1..99_usize)),
    )
        .prop_map(
            |(
                (crop, align_lines, scars, outliers, tip_radius),
                ((fill, undefined), filter_across, mirror, quarter_turns),
                more,
            )| {
                let (window, cells, rows) = more;
                let before = Preprocessing {
                    crop,
                    align_lines,
                    scars,
                    outliers,
                    tip_radius,
                    ..Preprocessing::default()
                };
                Preprocessing {
                    fill,
                    undefined,
                    filter_across,
                    mirror,
                    quarter_turns,
                    window,
                    cells,
                    rows,
                    ..before
                }
            },
        )
        .boxed()
}

fn length_of(dimension: Dimension) -> impl Strategy<Value = Quantity> {
    positive().prop_map(move |value| Quantity::new(value, dimension).unwrap())
}

fn file(system: System) -> BoxedStrategy<AskedFile> {
    let dimension = if system == System::Si { Dimension::LENGTH } else { Dimension::NONE };
    let length = move || length_of(dimension);
    let sides = move || prop_oneof![length().prop_map(Sides::One), [length(), length()].prop_map(Sides::Two)];
    let places = prop_oneof![
        Just((None, None)),
        sides().prop_map(|size| (Some(size), None)),
        sides().prop_map(|cell| (None, Some(cell)))
    ];
    let channel = prop_oneof![
        (0..9_usize).prop_map(ChannelChoice::Number),
        "[a-z]\\PC{0,8}".prop_map(ChannelChoice::Name)
    ];
    let declared = (
        (of(select(Format::ALL.to_vec())), of(channel), of(select(vec!["nm", "um", "none"])), of(length())),
        (places, of(select(Axes::ALL.to_vec())), of(select(Border::ALL.to_vec()))),
        (
            select(Decimal::ALL.to_vec()),
            of(prop_oneof![Just(-9999.0), Just(f64::INFINITY), positive()]),
            0..4_usize,
        ),
    )
        .prop_map(
            |(
                (format, channel, unit, height_scale),
                ((size, cell), axes, border),
                (decimal, missing, skip_lines),
            )| {
                let unit = unit.map(|unit| unit.parse().unwrap());
                let declared = ReadOptions {
                    format,
                    channel,
                    height_scale,
                    size,
                    cell,
                    axes,
                    border,
                    ..ReadOptions::default()
                };
                ReadOptions { unit, decimal, missing, skip_lines, ..declared }
            },
        );
    let twin = of(select(vec![TwinSpectrum::EachWave, TwinSpectrum::Rings]));
    let path = of("[a-z \"]{1,9}".prop_map(PathBuf::from));
    (path, declared, preprocessing(dimension), of(select(Detrend::ALL.to_vec())), twin, of(any::<bool>()))
        .prop_map(|(path, declared, preprocessing, detrend, twin, keep_heights)| AskedFile {
            path,
            content: None,
            declared,
            preprocessing,
            detrend,
            twin,
            keep_heights,
        })
        .boxed()
}

fn effects() -> BoxedStrategy<Effects> {
    let law = select(vec![AdhesionLaw::Exponential, AdhesionLaw::Dugdale]);
    let adhesion = prop_oneof![
        Just(Adhesion::Off),
        positive().prop_map(|work| Adhesion::ShortRange { work }),
        (positive(), positive(), law).prop_map(|(work, range, law)| Adhesion::FiniteRange {
            work,
            range,
            law
        })
    ];
    let law_of_friction = prop_oneof![
        share().prop_map(FrictionLaw::coulomb),
        positive().prop_map(FrictionLaw::tresca),
        (share(), of(positive()), of(positive())).prop_map(|(coefficient, strength, limit)| {
            FrictionLaw { coefficient, shear_strength: strength.unwrap_or(0.0), limit }
        })
    ];
    let friction = prop_oneof![
        Just(Friction::Off),
        (law_of_friction, of(select(vec![Coupling::Neglected, Coupling::Full])))
            .prop_map(|(law, coupling)| Friction::of(law).with_coupling(coupling))
    ];
    let arm = || (positive(), positive()).prop_map(|(weight, time)| Relaxing { weight, time });
    let rheology = prop_oneof![
        Just(Rheology::Elastic),
        positive().prop_map(|viscosity| Rheology::KelvinVoigt { viscosity }),
        positive().prop_map(|viscosity| Rheology::Maxwell { viscosity }),
        arm().prop_map(|arm| Rheology::StandardSolid { arm }),
        vec(arm(), 1..4).prop_map(|arms| Rheology::Prony(PronySeries::new(&arms).unwrap()))
    ];
    let hardness =
        prop_oneof![Just(Hardness::Off), positive().prop_map(|pressure| Hardness::Limit { pressure })];
    let material = || (1e9..1e12_f64, share());
    let base = prop_oneof![
        Just(LayerBase::Rigid),
        Just(LayerBase::Slipping),
        material().prop_map(|(young, poisson)| LayerBase::HalfSpace { young, poisson })
    ];
    let layer = of((positive(), material(), base).prop_map(|(thickness, (young, poisson), base)| Layer {
        thickness,
        young,
        poisson,
        base,
    }));
    (select(Boundary::ALL.to_vec()), hardness, adhesion, friction, rheology, layer)
        .prop_map(|(boundary, hardness, adhesion, friction, rheology, layer)| {
            let mut effects = Effects::default();
            (effects.boundary, effects.hardness, effects.adhesion) = (boundary, hardness, adhesion);
            (effects.friction, effects.rheology, effects.layer) = (friction, rheology, layer);
            effects
        })
        .boxed()
}

fn outputs() -> BoxedStrategy<RequestedOutputs> {
    let formats = || subsequence(vec![FieldFormat::Npy, FieldFormat::Png, FieldFormat::Vti], 0..=3);
    let conductance = prop_oneof![
        Just(Conductance::Off),
        (positive(), positive()).prop_map(|(first, second)| Conductance::Electrical { first, second }),
        (positive(), positive()).prop_map(|(first, second)| Conductance::Thermal { first, second })
    ];
    let numbers = vec(any::<bool>(), Output::ALL.len());
    let distributions = subsequence(Distributed::ALL.map(|(_, of)| of).to_vec(), 0..=4);
    let flags = (any::<bool>(), any::<bool>(), any::<[bool; 2]>(), of(vec(0..5_usize, 0..3)), interface());
    (numbers, formats(), formats(), conductance, distributions, flags)
        .prop_map(
            |(
                numbers,
                pressure,
                heights,
                conductance,
                distributions,
                (grid_error, statistics, [curves, law], drawn_states, interface),
            )| {
                let mut requested = RequestedOutputs {
                    heights,
                    distributions,
                    grid_error,
                    statistics,
                    interface,
                    law,
                    curves,
                    drawn_states,
                    ..RequestedOutputs::default()
                };
                for (output, asked) in
                    Output::ALL.iter().zip(numbers).filter(|(output, _)| !output.is_field())
                {
                    requested.outputs.ask(*output, asked);
                }
                requested.outputs.conductance = conductance;
                requested.files.extend((!pressure.is_empty()).then_some((Output::Pressure, pressure)));
                requested.request_what_files_need();
                requested
            },
        )
        .boxed()
}

fn interface() -> BoxedStrategy<RequestedInterface> {
    let along = select(vec![FlowAxis::X, FlowAxis::Y]);
    let leakage = (positive(), positive(), along)
        .prop_map(|(viscosity, pressure_drop, along)| RequestedLeakage { viscosity, pressure_drop, along });
    let body = of(select(vec![LoadedBody::First, LoadedBody::Second]));
    let section = of(select(vec![FlowAxis::X, FlowAxis::Y]));
    let stress = (vec(positive(), 1..4), of(positive()), body, section, of(1_usize..100)).prop_map(
        |(depths, yield_stress, body, section, layers)| RequestedStress {
            depths,
            yield_stress,
            body,
            section,
            layers,
        },
    );
    let material = prop_oneof![
        positive().prop_map(FilmMaterial::Resistivity),
        positive().prop_map(FilmMaterial::Conductivity)
    ];
    let film = (material, of(select(vec![FlowAxis::X, FlowAxis::Y])))
        .prop_map(|(material, along)| RequestedFilm { material, along });
    (of(leakage), any::<bool>(), of(stress), of(film))
        .prop_map(|(leakage, percolation, stress_below, film)| RequestedInterface {
            leakage,
            percolation,
            stress_below,
            film,
        })
        .boxed()
}

fn models() -> BoxedStrategy<Vec<Numerics>> {
    let all: Vec<Numerics> = Numerics::all().collect();
    let some = 1..all.len();
    (subsequence(all, some), 1..999_usize, of(1..999_usize), 1e-9..0.9_f64, 1..9_u32)
        .prop_map(|(mut models, cells, rows, number, count)| {
            for model in &mut models {
                match model {
                    Numerics::Bem3d(model) => {
                        (model.cells, model.rows, model.tolerance) = (cells, rows, number);
                    }
                    Numerics::Equivalent(outer) => (outer.model.cells, outer.decades) = (cells, count),
                    Numerics::Mdr1d(model) => model.elements = cells,
                    Numerics::Persson(model) => model.gamma = number,
                    _ => {}
                }
            }
            models
        })
        .boxed()
}

fn questions() -> BoxedStrategy<Question> {
    select(vec![System::Si, System::None])
        .prop_flat_map(|units| {
            let second = (file(units), of(of(select(Mirror::ALL.to_vec()))), of([positive(), positive()]))
                .prop_map(|(file, facing, offset)| AskedSecond { file, facing, offset });
            let surface = prop_oneof![
                self_affine().prop_map(|surface| (Some(AskedSurface::SelfAffine(surface)), None)),
                (file(units), of(second))
                    .prop_map(|(file, second)| (Some(AskedSurface::File(Box::new(file))), second)),
                Just((None, None))
            ];
            let kinds = crate::scenes::read::asked_surface::BODIES.map(|(name, _)| name);
            let body = (select(kinds.to_vec()).prop_map(Some), of(size()), of(positive()), of(positive()))
                .prop_map(|(kind, size, radius, slope)| AskedBody {
                    kind,
                    size,
                    radius,
                    slope,
                    ..AskedBody::default()
                });
            let accuracy = (prop_oneof![Just(0.0), 1e-3..0.9_f64], 1.0..1e5_f64, 1..99_u32).prop_map(
                |(share, seconds, gigabytes)| RequestedAccuracy {
                    memory: f64::from(gigabytes) * 1e9,
                    ..analysis::AccuracyTarget { share, seconds }.into()
                },
            );
            let sampling = (any::<u64>().prop_map(Some), of(1..99_u64))
                .prop_map(|(seed, surfaces)| AskedSampling { seed, surfaces });
            (
                models(),
                of(material()),
                of(positive()),
                (of(accuracy), of(loads())),
                surface,
                of(body),
                effects(),
                outputs(),
                of(sampling),
            )
                .prop_map(
                    move |(
                        models,
                        material,
                        hardness,
                        (accuracy, loads),
                        (surface, second_surface),
                        body,
                        effects,
                        outputs,
                        sampling,
                    )| {
                        Question {
                            units,
                            models,
                            material,
                            hardness,
                            accuracy,
                            loads,
                            surface,
                            second_surface,
                            body,
                            effects,
                            outputs,
                            sampling,
                        }
                    },
                )
        })
        .boxed()
}

/// The keys of a printed question with their values, in their order.
fn assignments(text: &str) -> Vec<(String, String)> {
    let (mut table, mut steps, mut list) = (String::new(), 0, Vec::new());
    for line in text.lines() {
        if line == "[[scene.path]]" {
            table = format!("scene.path.{steps}");
            steps += 1;
        } else if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            name.clone_into(&mut table);
        } else if let Some((key, value)) = line.split_once(" = ") {
            list.push((format!("{table}.{key}"), value.to_owned()));
        }
    }
    list
}

/// A scene of the repository has the same stored keys, whether its text is read, its question is asked, or
/// each of its keys is set by itself.
#[test]
fn every_way_to_ask_has_the_same_stored_keys() {
    use crate::scenes::SceneFile;
    use crate::scenes::run::scene_jobs;
    let keys = |scene: &SceneFile| -> Vec<String> {
        scene_jobs(scene, &std::path::Path::new("out").into()).iter().map(runs::Job::stored_key).collect()
    };
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        count += 1;
        let read = SceneFile::read(&path).unwrap();
        let question = Question::parse(&read.text).unwrap();
        let mut set = Question::default();
        for (key, value) in assignments(&question.to_toml()) {
            set.set(&key, &value).unwrap();
        }
        for asked in [question, set] {
            assert_eq!(keys(&SceneFile::of(asked, &path).unwrap()), keys(&read), "{}", path.display());
        }
    }
    assert!(count > 30);
}

proptest! {
    #[test]
    fn every_question_is_printed_and_read_as_itself(question in questions()) {
        let text = question.to_toml();
        prop_assert_eq!(Question::parse(&text).map_err(|error| error.to_string()), Ok(question.clone()), "{}", text);
        // And so it is where each key is set by itself, as flags do.
        let mut set = Question::default();
        for (key, value) in assignments(&text) {
            prop_assert_eq!(set.set(&key, &value).map_err(|error| error.to_string()), Ok(()), "{}", key);
        }
        set.outputs.request_what_files_need();
        prop_assert_eq!(set.to_toml(), text);
    }
}
