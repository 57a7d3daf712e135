//! The files of a run as bytes. Whoever asks for them decides where they go.

use crate::scenes::read::{Result, words};
use crate::scenes::tell::{
    MapStatisticsTables, StateTable, cycles, distributions, law, pictures, thresholds,
};
use contact_model::Table;
use runs::{Header, csv_bytes};

/// Receives the name and the bytes of a file.
pub(crate) type Receive<'a> = dyn FnMut(&str, Vec<u8>) -> Result<()> + 'a;

/// Makes the tables and the pictures of curves of a run, one after the other. The report has a function of its
/// own, because it also needs the fields and the outcome.
///
/// # Errors
/// Pictures that cannot be encoded, and those of `receive`.
pub(crate) fn make(
    states: &StateTable<'_>,
    results: &Table,
    statistics: Option<&MapStatisticsTables>,
    header: &Header,
    receive: &mut Receive<'_>,
) -> Result<()> {
    let requested = &states.scene.requested;
    receive("results.csv", csv_bytes(results, header))?;
    if requested.outputs.contact_patches {
        receive("patches.csv", csv_bytes(&states.patches()?, header))?;
    }
    if cycles::are_counted(states.scene) {
        receive(cycles::FILE, csv_bytes(&cycles::table(states)?, header))?;
    }
    if requested.law {
        receive(law::FILE, csv_bytes(&law::table(states)?, header))?;
    }
    if thresholds::are_told(states.scene) {
        receive(thresholds::FILE, csv_bytes(&thresholds::table(states)?, header))?;
    }
    if let Some(means) = states.ensemble()? {
        receive("ensemble.csv", csv_bytes(&means, header))?;
    }
    for &of in &requested.distributions {
        let table = distributions::table(states, of)?;
        receive(&format!("distribution-{}.csv", of.name()), csv_bytes(&table, header))?;
    }
    for &of in &requested.distributions {
        if let Some(chart) = distributions::chart(states, of) {
            send(chart.files(&format!("distribution-{}", of.name()))?, receive)?;
        }
    }
    if requested.curves {
        for (y, chart) in pictures::charts(states) {
            send(chart.files(&format!("curve-{y}"))?, receive)?;
        }
    }
    if let Some(statistics) = statistics {
        statistics.files(header, &words::scene_name(states.scene), receive)?;
    }
    Ok(())
}

/// Passes on the files of a picture.
pub(crate) fn send(files: [(String, Vec<u8>); 2], receive: &mut Receive<'_>) -> Result<()> {
    files.into_iter().try_for_each(|(name, bytes)| receive(&name, bytes))
}
